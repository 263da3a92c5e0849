"""The tables of `cohabit export` in pandas, and each outcome by condition: run it, or copy it into a notebook.

Needs pandas; statsmodels too for the mixed models, of which it warns where the variance of participants is 0. What each
column means is in the table `codebook`. Edit this file as you like: exporting again leaves it as it is.
"""

from pathlib import Path

import pandas as pd

FOLDER = Path(__file__).parent if "__file__" in globals() else Path(".")
TYPES = {"text": "string", "whole number": "Int64", "real number": "Float64", "true or false": "boolean"}
# Text that a spreadsheet program would take for a formula has an apostrophe before it in CSV files.
FORMULA = r"^'(?='*[=+\-@\t\r\n])"


# Tables may lie here as CSV and as Parquet. Each export writes its codebook last: the newer one tells which tables are.
BOOKS = [book for book in (FOLDER / "codebook.csv", FOLDER / "codebook.parquet") if book.exists()]
BOOK = max(BOOKS, key=lambda book: book.stat().st_mtime_ns, default=FOLDER / "codebook.parquet")


def table(name):
    """One of: sessions, turns, actions, goals, questionnaires, codebook; social, where there were people."""
    is_csv = BOOK.suffix == ".csv"
    fields = pd.read_csv(BOOK, dtype="string") if is_csv else pd.read_parquet(BOOK)
    if name not in set(fields["table"]):
        raise FileNotFoundError(f"{name}: the last export to {FOLDER} has no such table")
    if not is_csv:
        return pd.read_parquet(FOLDER / f"{name}.parquet")
    fields = fields[(fields["table"] == name) & fields["type"].isin(TYPES)]
    types = {field: TYPES[kind] for field, kind in zip(fields["name"], fields["type"])} or "string"
    data = pd.read_csv(FOLDER / f"{name}.csv", dtype=types, keep_default_na=False, na_values=[""])
    text = data.select_dtypes("string").columns
    data[text] = data[text].apply(lambda column: column.str.replace(FORMULA, "", regex=True))
    return data


sessions = table("sessions")
outcomes = ["success", "actions", "failed_actions", "questions", "answered_ms", "understood_ms", "moved_ms"]
outcomes += [name for name in sessions if name.startswith("score_")]
sessions[outcomes] = sessions[outcomes].astype("float64")

# The settings in which sessions differ. Other conditions can be named here: "mission", or any column.
conditions = [name for name in sessions if name.startswith("setting_") and sessions[name].nunique(dropna=False) > 1]
# Without a name, each session is a participant of its own.
sessions["participant"] = sessions["participant"].fillna(sessions["session"])
repeated = sessions["participant"].duplicated().any()

# A participant's means in each condition: one row a participant, one column a condition.
means = sessions.pivot_table(index="participant", columns=conditions, values=outcomes) if conditions else None

if __name__ == "__main__":
    print(sessions.groupby(conditions or "mission", dropna=False)[outcomes].agg(["count", "mean", "std"]).T.to_string())
    if conditions and repeated:
        import statsmodels.formula.api as smf

        for outcome in outcomes:
            data = sessions.dropna(subset=[outcome])
            if data[outcome].nunique() < 2:
                continue
            formula = f"Q('{outcome}') ~ " + " + ".join(f"C(Q('{name}'))" for name in conditions)
            print(f"\n{outcome}")
            try:
                print(smf.mixedlm(formula, data, groups=data["participant"]).fit(reml=True).summary())
            except Exception as error:
                print(f"not fitted: {error}")
