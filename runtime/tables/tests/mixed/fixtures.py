"""Writes the fixtures of tests/mixed: data sets as CSV, and in expected.json what statsmodels makes of them.

    pip install statsmodels==0.15.0 pandas==3.1.1 numpy==2.4.6 scipy==1.17.1
    python fixtures.py SLEEPSTUDY_CSV

Estimates, variances and the restricted log-likelihood are those of statsmodels' MixedLM. It has neither Satterthwaite's degrees
of freedom nor the boundary, and its standard errors are of the joint information of fixed effects and variances, a little
larger than those of lme4 and SAS in unbalanced designs. So these follow from `Dense`: the definitions spelled out with full
matrices and numerical second derivatives. Effect sizes are by scipy's noncentral t, and printed for the unit tests.

Data sets with published results:
- sleepstudy: Belenky et al. (2003), J. Sleep Res. 12, 1-12, as in sleep.csv of pymer4 0.9.2 (MIT licence).
- dyestuff, dyestuff2: Davies (1947) and Box and Tiao (1973), as printed in Bates, lme4: Mixed-effects modeling with R,
  chapter 1. All others are made up here.
"""

import json
import sys
import warnings

import numpy as np
import pandas as pd
import scipy
import scipy.optimize
import scipy.stats
import statsmodels
import statsmodels.formula.api as smf
from statsmodels.tools.numdiff import approx_hess3

DYESTUFF = {
    "A": [1545, 1440, 1440, 1520, 1580],
    "B": [1540, 1555, 1490, 1560, 1495],
    "C": [1595, 1550, 1605, 1510, 1560],
    "D": [1445, 1440, 1595, 1465, 1545],
    "E": [1595, 1630, 1515, 1635, 1625],
    "F": [1520, 1455, 1450, 1480, 1445],
}
DYESTUFF2 = {
    "A": [7.298, 3.846, 2.434, 9.566, 7.990],
    "B": [5.220, 6.556, 0.608, 11.788, -0.892],
    "C": [0.110, 10.386, 13.434, 5.510, 8.166],
    "D": [2.212, 4.852, 7.092, 9.288, 4.980],
    "E": [0.282, 9.014, 4.458, 9.446, 7.198],
    "F": [1.722, 4.782, 8.106, 0.758, 3.758],
}


def table(values):
    return pd.DataFrame([{"participant": who, "y": y} for who, ys in values.items() for y in ys])


def simulated(seed, participants, levels, sessions, effect, spread, noise, between=None):
    """Participants who each meet all combinations of the levels of factors, so many times."""
    random = np.random.default_rng(seed)
    rows = []
    for number in range(participants):
        intercept = random.normal(0, spread)
        own = {"participant": f"P{number + 1:02}"}
        if between:
            own["group"] = between[number % len(between)]
        for cell in np.ndindex(*(len(names) for names in levels.values())):
            conditions = own | {name: names[at] for (name, names), at in zip(levels.items(), cell)}
            for _ in range(sessions):
                y = 20 + effect(conditions) + intercept + random.normal(0, noise)
                rows.append(conditions | {"y": round(y, 4)})
    return pd.DataFrame(rows)


def without_participants(data, mean=20.0, by=0.05):
    """Participants' means drawn together, so that they differ less than their own sessions do."""
    means = data.groupby("participant")["y"].transform("mean")
    return data.assign(y=(data["y"] - means + mean + by * (means - mean)).round(4))


ASK = {"ask": ["always", "never", "unsure"]}
BOTH = {"ask": ["always", "never"], "voice": ["high", "low"]}
STEP = {"always": 0.0, "never": 3.0, "unsure": 1.0}


def designs(sleepstudy):
    balanced = simulated(1, 12, ASK, 2, lambda own: STEP[own["ask"]], 4.0, 2.0)
    unbalanced = simulated(2, 14, ASK, 2, lambda own: STEP[own["ask"]], 3.0, 3.0)
    unbalanced = unbalanced.sample(frac=0.6, random_state=2).sort_index()
    two = simulated(
        3, 10, BOTH, 1, lambda own: 2 * (own["ask"] == "never") * (own["voice"] == "low"), 2.0, 1.5
    )
    mixed = simulated(
        4, 15, ASK, 1, lambda own: STEP[own["ask"]] + (own["group"] == "wizard"), 2.5, 2.0, ["alone", "wizard"]
    )
    mixed = mixed.drop(index=[4, 17, 30])
    sleep = sleepstudy.rename(columns={"Subject": "participant", "Days": "days", "Reaction": "y"})
    return {
        "balanced": (balanced, ["ask"]),
        "unbalanced": (unbalanced, ["ask"]),
        "boundary": (without_participants(simulated(5, 9, ASK, 2, lambda own: STEP[own["ask"]], 1.0, 3.0)), ["ask"]),
        "two_within": (two, ["ask", "voice"]),
        "two_within_interaction": ("two_within", ["ask", "voice", "ask:voice"]),
        "between_and_within": (mixed, ["group", "ask", "group:ask"]),
        "few_participants": (simulated(6, 3, ASK, 2, lambda own: STEP[own["ask"]], 3.0, 1.0), ["ask"]),
        "sleepstudy": (sleep, ["days"]),
        "dyestuff": (table(DYESTUFF), []),
        "dyestuff2": (table(DYESTUFF2), []),
    }


def formula(data, terms):
    """Treatment coding against the commonest level, of several the first in the alphabet."""

    def coded(name):
        if data[name].dtype.kind in "if":
            return name
        counts = data[name].value_counts()
        reference = sorted(counts[counts == counts.max()].index)[0]
        return f"C({name}, Treatment('{reference}'))"

    return "y ~ " + " + ".join(["1"] + [":".join(coded(part) for part in term.split(":")) for term in terms])


class Dense:
    """The model by its definition."""

    def __init__(self, y, X, participants):
        self.y, self.X = y, X
        Z = pd.get_dummies(participants).to_numpy(float)
        self.K, (self.n, self.p) = Z @ Z.T, X.shape
        zero, grid = self.slope(0.0), [0.0] + [10 ** (k / 2) for k in range(-10, 17)]
        falls = [(a, b) for a, b in zip(grid, grid[1:]) if self.slope(a) < 0 <= self.slope(b)]
        minima = [scipy.optimize.brentq(self.slope, a, b, xtol=1e-15, rtol=1e-14) for a, b in falls]
        minima += [0.0] if zero >= 0 else []
        self.theta = min(minima, key=lambda theta: self.deviance(theta, self.variance(theta)))
        self.sigma2 = self.variance(self.theta)
        V = self.V(self.theta)
        self.beta = np.linalg.solve(X.T @ np.linalg.solve(V, X), X.T @ np.linalg.solve(V, y))
        self.C = self.covariance(self.theta, self.sigma2)
        if self.theta > 0:
            at = np.array([self.theta, self.sigma2])
            scaled = lambda x: self.deviance(x[0] * at[0], x[1] * at[1])
            hessian = approx_hess3(np.ones(2), scaled, epsilon=1e-3) / np.outer(at, at)
            self.A = 2 * np.linalg.inv(hessian)

    def V(self, theta):
        return np.eye(self.n) + theta * self.K

    def P(self, theta):
        W = np.linalg.inv(self.V(theta))
        return W - W @ self.X @ np.linalg.solve(self.X.T @ W @ self.X, self.X.T @ W)

    def variance(self, theta):
        return self.y @ self.P(theta) @ self.y / (self.n - self.p)

    def slope(self, theta):
        P = self.P(theta)
        Py = P @ self.y
        return np.trace(P @ self.K) - (self.n - self.p) * (Py @ self.K @ Py) / (self.y @ Py)

    def deviance(self, theta, sigma2):
        V = self.V(theta)
        XVX = self.X.T @ np.linalg.solve(V, self.X)
        fixed = (self.n - self.p) * np.log(2 * np.pi * sigma2) + self.y @ self.P(theta) @ self.y / sigma2
        return fixed + np.linalg.slogdet(V)[1] + np.linalg.slogdet(XVX)[1]

    def covariance(self, theta, sigma2):
        return sigma2 * np.linalg.inv(self.X.T @ np.linalg.solve(self.V(theta), self.X))

    def freedom(self, L):
        """Satterthwaite's, as in lmerTest: gradient by central differences."""
        if self.theta == 0:
            return self.n - self.p
        of = lambda theta, sigma2: L @ self.covariance(theta, sigma2) @ L
        h = 1e-5
        t, s = self.theta, self.sigma2
        gradient = np.array(
            [
                (of(t * (1 + h), s) - of(t * (1 - h), s)) / (2 * h * t),
                (of(t, s * (1 + h)) - of(t, s * (1 - h))) / (2 * h * s),
            ]
        )
        return 2 * of(t, s) ** 2 / (gradient @ self.A @ gradient)

    def test(self, places):
        """F, and the degrees of freedom of lmerTest's contestMD."""
        values, vectors = np.linalg.eigh(self.C[np.ix_(places, places)])
        rows = np.zeros((len(places), self.p))
        rows[:, places] = vectors.T
        t2 = (rows @ self.beta) ** 2 / values
        nu = np.array([self.freedom(row) for row in rows])
        if np.ptp(nu) < 1e-3:
            ddf = nu.mean()
        else:
            E = (nu / (nu - 2)).sum()
            ddf = 2 * E / (E - len(places))
        F = t2.mean()
        return {"f": F, "freedom": [len(places), ddf], "p": scipy.stats.f.sf(F, len(places), ddf)}


def expected(data, terms):
    model = smf.mixedlm(formula(data, terms), data, groups=data["participant"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fit = model.fit(reml=True, method=["bfgs", "lbfgs", "powell", "bfgs"], gtol=1e-9)
    dense = Dense(model.endog, model.exog, data["participant"])
    names = list(model.exog_names)
    print(f"  theta {dense.theta:.6g}, statsmodels {fit.cov_re.iloc[0, 0] / fit.scale:.6g}")
    units = np.eye(len(names))
    def columns(term):
        if ":" in term:
            return [at for at, name in enumerate(names) if ":" in name]
        own = [at for at, name in enumerate(names) if name.startswith(f"C({term},") and ":" not in name]
        return own or [names.index(term)]

    inside = {part for term in terms if ":" in term for part in term.split(":")}
    tests = {term: dense.test(columns(term)) for term in terms if term not in inside}
    return {
        "terms": terms,
        "names": names,
        "statsmodels": {
            "estimates": fit.fe_params.tolist(),
            "standard_errors": fit.bse_fe.tolist(),
            "participant_sd": float(np.sqrt(fit.cov_re.iloc[0, 0])),
            "residual_sd": float(np.sqrt(fit.scale)),
            "log_likelihood": float(fit.llf),
        },
        "dense": {
            "estimates": dense.beta.tolist(),
            "standard_errors": np.sqrt(np.diag(dense.C)).tolist(),
            "freedoms": [float(dense.freedom(unit)) for unit in units],
            "participant_sd": float(np.sqrt(dense.theta * dense.sigma2)),
            "residual_sd": float(np.sqrt(dense.sigma2)),
            "log_likelihood": float(-0.5 * dense.deviance(dense.theta, dense.sigma2)),
            "tests": tests,
        },
    }


def limits(t, freedom):
    """Of the noncentrality. Far from t scipy's cdf is not a number, where it is 0 or 1."""
    cdf = lambda nc: np.nan_to_num(scipy.stats.nct.cdf(t, freedom, nc), nan=float(nc < t))
    reach = 6 + 2 * abs(t)
    return [scipy.optimize.brentq(lambda nc: cdf(nc) - p, t - reach, t + reach, xtol=1e-13) for p in (0.975, 0.025)]


def effect_sizes():
    pairs = np.array(
        [[1.9, 0.7], [0.8, -1.6], [1.1, -0.2], [0.1, -1.2], [-0.1, -0.1]]
        + [[4.4, 3.4], [5.5, 3.7], [1.6, 0.8], [4.6, 0.0], [3.4, 2.0]]
    )
    n, differences, (va, vb) = len(pairs), pairs[:, 0] - pairs[:, 1], pairs.var(axis=0, ddof=1)
    pooled, nu = np.sqrt((va + vb) / 2), 2 * n - 2
    J = np.exp(scipy.special.gammaln(nu / 2) - scipy.special.gammaln((nu - 1) / 2)) / np.sqrt(nu / 2)
    d, unit = differences.mean() / pooled, np.sqrt(2 / n)
    print("g", J * d, *(unit * np.array(limits(d / unit, nu))))
    t = differences.mean() / differences.std(ddof=1) * np.sqrt(n)
    print("d_z", t / np.sqrt(n), *(np.array(limits(t, n - 1)) / np.sqrt(n)))
    unit = np.sqrt(2 * (va + vb - 2 * np.cov(pairs.T)[0, 1]) / (n * (va + vb)))
    print("d_av", differences.mean() / pooled, *(unit * np.array(limits(t, n - 1))))
    welch = scipy.stats.ttest_ind([1, 0.5, 0.5], [0, 0.25, 0.5, 0], equal_var=False)
    print("welch", 2 / 3 - 0.1875, *welch.confidence_interval(0.95))
    for t, freedom in [(0.0, 9), (-2.1, 4), (4.06, 9), (12.5, 1), (31.0, 20), (3.0, 300)]:
        print("nct", t, freedom, *limits(t, freedom))
    for counts in [(36, 12, 2, 0), (1, 1, 7, 12), (53, 16, 8, 9), (10, 0, 0, 10), (0, 0, 5, 5), (2, 9, 8, 1)]:
        print("paired", counts, *newcombe_paired(*counts))


def newcombe_paired(e, f, g, h):
    """Method 10 of Newcombe (1998), Stat. Med. 17, 2635-2650."""
    from statsmodels.stats.proportion import proportion_confint

    n = e + f + g + h
    p2, p3 = (e + f) / n, (e + g) / n
    (l2, u2), (l3, u3) = (proportion_confint(k, n, method="wilson") for k in (e + f, e + g))
    A, B = (e + f) * (g + h) * (e + g) * (f + h), e * h - f * g
    C = B - n / 2 if B > n / 2 else 0 if B >= 0 else B
    phi = C / np.sqrt(A) if A else 0
    down = np.sqrt((p2 - l2) ** 2 - 2 * phi * (p2 - l2) * (u3 - p3) + (u3 - p3) ** 2)
    up = np.sqrt((u2 - p2) ** 2 - 2 * phi * (u2 - p2) * (p3 - l3) + (p3 - l3) ** 2)
    return p2 - p3, p2 - p3 - down, p2 - p3 + up


def main():
    sets = designs(pd.read_csv(sys.argv[1]))
    modules = {module.__name__: module.__version__ for module in [statsmodels, pd, np, scipy]}
    result = {"versions": modules, "designs": {}}
    for name, (data, terms) in sets.items():
        print(name)
        file = data if isinstance(data, str) else name
        data = sets[file][0]
        data.to_csv(f"{file}.csv", index=False)
        result["designs"][name] = {"data": f"{file}.csv"} | expected(data, terms)
    with open("expected.json", "w") as file:
        json.dump(result, file, indent=1)
        file.write("\n")
    effect_sizes()


main()
