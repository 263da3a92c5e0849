// Looks over the page that it runs in, and gives what keeps people from using it. It knows no page in particular.
(() => {
  const problems = [];
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const tell = (what, node) => problems.push(`${what}: ${node.outerHTML.slice(0, 160)}`);
  const isShown = (node) => node.checkVisibility({ visibilityProperty: true });
  const isTold = (node) => isShown(node) && !node.closest("[aria-hidden=true]");
  // What lies behind an open card cannot be used, nor has it to be.
  const root = document.querySelector("dialog[open]") ?? document;
  const CONTROLS = "a[href], button, input:not([type=hidden]), select, textarea";

  const words = (node) => {
    if (node.nodeType === Node.TEXT_NODE) return node.textContent;
    if (node.nodeType !== Node.ELEMENT_NODE || node.getAttribute("aria-hidden") === "true") return "";
    if (node.matches("img")) return node.alt;
    return node.getAttribute("aria-label") ?? [...node.childNodes].map(words).join(" ");
  };
  const referred = (node, attribute) => (node.getAttribute(attribute) ?? "").split(/\s+/).filter(Boolean);
  const nameOf = (node) => {
    const labelled = referred(node, "aria-labelledby").map((id) => document.getElementById(id)).filter(Boolean).map(words);
    const label = [...(node.labels ?? [])].map(words);
    const content = node.matches("a, button") ? [words(node)] : [];
    return [...labelled, node.getAttribute("aria-label"), ...label, ...content, node.title].find((text) => text?.trim()) ?? "";
  };

  // Names, of what is used and of what is looked at.
  for (const node of all(`${CONTROLS}, iframe, canvas, [role=img], [role=group], [role=radiogroup], [role=region], dialog[open]`, root)) {
    if (isTold(node) && !nameOf(node)) tell("it has no name", node);
  }
  for (const node of all("img")) if (!node.hasAttribute("alt")) tell("it has no alternative text", node);

  // What is referred to, and what is hidden from some and used by others.
  const ids = new Set();
  for (const node of all("[id]")) {
    if (ids.has(node.id)) tell("its id is there twice", node);
    ids.add(node.id);
  }
  for (const attribute of ["aria-labelledby", "aria-describedby", "aria-controls", "for"]) {
    for (const node of all(`[${attribute}]`)) {
      for (const id of referred(node, attribute)) if (!ids.has(id)) tell(`${attribute} leads nowhere`, node);
    }
  }
  for (const node of all(`[aria-hidden=true] :is(${CONTROLS}, [tabindex="0"])`)) {
    if (isShown(node) && node.tabIndex >= 0) tell("it is used, and not told", node);
  }
  for (const node of all("[tabindex]")) if (node.tabIndex > 0) tell("it goes before its turn", node);

  // The page as a whole.
  if (!document.documentElement.lang) problems.push("the page has no language");
  if (!document.title.trim()) problems.push("the page has no title");
  if (all("main").filter(isShown).length !== 1) problems.push("the page has not one main part");
  let level = 0;
  for (const node of all("h1, h2, h3, h4, h5, h6").filter(isTold)) {
    const next = Number(node.tagName[1]);
    if (next > level + 1) tell(`a heading of level ${next} after one of ${level}`, node);
    level = next;
  }
  if (document.documentElement.scrollWidth > innerWidth) problems.push(`the page is ${document.documentElement.scrollWidth} px wide`);

  // Sizes: 24 px either way, but for links within a text. Of what lies in a label, the label is the target.
  for (const node of all(CONTROLS, root)) {
    if (!isTold(node) || node.tabIndex < 0 || node.disabled || (node.matches("a") && getComputedStyle(node).display === "inline")) continue;
    if (node.matches(".skip")) continue;
    const { width, height } = (node.closest("label") ?? node).getBoundingClientRect();
    if (Math.min(width, height) < 23.5) tell(`it is ${Math.round(width)} by ${Math.round(height)} px`, node);
  }

  // Contrast, against each colour that may lie behind: pictures may have any.
  const parse = (text) => {
    const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
    return { rgb: [r, g, b], a };
  };
  const over = ({ rgb, a }, below) => rgb.map((value, at) => value * a + below[at] * (1 - a));
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (one, other) => {
    const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const overlap = (one, other) => {
    const [a, b] = [one.getBoundingClientRect(), other.getBoundingClientRect()];
    return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  };
  const behind = (node, text) => {
    if (!node) return [[255, 255, 255]];
    const style = getComputedStyle(node);
    const hasPicture = all(":scope > canvas, :scope > img", node).some((picture) => overlap(picture, text));
    let below = hasPicture ? [[0, 0, 0], [255, 255, 255]] : behind(node.parentElement, text);
    const own = parse(style.backgroundColor);
    if (!hasPicture && own.a > 0) below = below.map((rgb) => over(own, rgb));
    const drawn = style.backgroundImage.match(/rgba?\([^)]*\)/g) ?? [];
    return drawn.length ? drawn.flatMap((colour) => below.map((rgb) => over(parse(colour), rgb))) : below;
  };
  const opacityOf = (node) => (node ? Number(getComputedStyle(node).opacity) * opacityOf(node.parentElement) : 1);
  const seen = new Set();
  const texts = document.createTreeWalker(root === document ? document.body : root, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const node = texts.currentNode.parentElement;
    if (!texts.currentNode.textContent.trim() || seen.has(node) || !isShown(node)) continue;
    seen.add(node);
    // Off the screen, drawn as a picture, or for nobody to use now.
    if (node.closest("svg, script, style, option, .unseen, :disabled, [aria-disabled=true]") || node.getClientRects().length === 0) continue;
    const style = getComputedStyle(node);
    const colour = parse(style.color);
    colour.a *= opacityOf(node);
    const size = parseFloat(style.fontSize);
    const wanted = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
    const worst = Math.min(...behind(node, node).map((rgb) => contrast(over(colour, rgb), rgb)));
    if (worst < wanted) tell(`its contrast is ${worst.toFixed(2)}`, node);
  }
  return problems;
})()
