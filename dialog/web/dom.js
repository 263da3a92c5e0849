// Small things that every part of the page makes its elements with.

import { language, text as words } from "./texts.js";

export const byId = (id) => document.getElementById(id);
export const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
export const narrow = window.matchMedia("(max-width: 820px)");

export function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

export function drawn(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export const capitalised = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** The most characters of a text, as the session told; its own limit, counted as it counts them. */
let longestText = Infinity;

export function limitTexts(longest = Infinity) {
  longestText = longest;
}

/** What is wrong with a text that is too long; nothing, if it is not. */
export function tooLong(text) {
  const length = [...text].length;
  return length > longestText ? words("too_long", { length, longest: longestText }) : "";
}

const TOAST_MS = 5000;

/** Says something for a while, in the language of the page if no other is named. */
export function toast(text, lang = language) {
  const shown = element("p", "toast", text);
  shown.lang = lang;
  byId("toasts").replaceChildren(shown);
  setTimeout(() => shown.remove(), TOAST_MS);
}
