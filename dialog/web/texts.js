// What people read on this page, in its language: the server writes the table into the page.

const table = JSON.parse(document.getElementById("texts").textContent);

/** The language of the page, as a tag. What the session and the robot say is English. */
export const { lang: language } = document.documentElement;

/** The text of a key, with these values where it has names in braces. */
export function text(key, values = {}) {
  return table[key].replace(/\{(\w+)\}/g, (all, name) => String(values[name] ?? all));
}
