// What a wizard can have the robot do with what they clicked: a menu where the click was.

import { byId, capitalised, element } from "./dom.js";

const GAP_PX = 6;
const menu = byId("menu");
/** Where the last click was, px from the left and from the top of the window. */
let clicked = [0, 0];
/** What had the focus before the menu took it. */
let before = null;

export const isMenuOpen = () => !menu.hidden;

export function noteClick({ clientX, clientY }) {
  clicked = [clientX, clientY];
  closeMenu();
}

/** Shows what is offered; `choose` is given the one that is chosen. */
export function openMenu(name, choices, choose) {
  before = document.activeElement;
  menu.setAttribute("aria-label", `What to do: ${name}`);
  menu.replaceChildren(element("p", "menu-name", capitalised(name)), ...choices.map((choice, index) => {
    const button = element("button");
    button.type = "button";
    button.append(element("span", "", choice.label));
    if (index < 9) button.append(element("kbd", "", String(index + 1)));
    button.addEventListener("click", () => {
      closeMenu();
      choose(choice);
    });
    return button;
  }));
  menu.hidden = false;
  const place = (at, size, all) => Math.max(GAP_PX, Math.min(at, all - size - GAP_PX));
  menu.style.left = `${place(clicked[0], menu.offsetWidth, window.innerWidth)}px`;
  menu.style.top = `${place(clicked[1], menu.offsetHeight, window.innerHeight)}px`;
  menu.querySelector("button")?.focus();
}

export function closeMenu() {
  if (menu.hidden) return;
  menu.hidden = true;
  if (menu.contains(document.activeElement)) before?.focus?.();
}

/** Escape closes an open menu, arrows go through it, and a digit chooses. Whether it was one of these. */
export function takeMenuKey({ key }) {
  if (menu.hidden) return false;
  const buttons = [...menu.querySelectorAll("button")];
  const at = buttons.indexOf(document.activeElement);
  const steps = { ArrowDown: 1, ArrowUp: -1 };
  if (key === "Escape") closeMenu();
  else if (key in steps) buttons[(at + steps[key] + buttons.length) % buttons.length].focus();
  else if (/^[1-9]$/.test(key) && buttons[key - 1]) buttons[key - 1].click();
  else return false;
  return true;
}

document.addEventListener("pointerdown", ({ target }) => {
  if (!menu.contains(target)) closeMenu();
});
