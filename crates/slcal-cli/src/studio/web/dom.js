// Building and changing the page's elements. Data only ever becomes text or attributes, never HTML.

const SVG = "http://www.w3.org/2000/svg";

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else set(node, name, value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

export const el = (tag, attributes = {}, ...children) => fill(document.createElement(tag), attributes, children);
export const svg = (tag, attributes = {}, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

/** An attribute; false, null and undefined take it away. Unchanged ones are left alone, so that nothing is announced twice. */
export function set(node, name, value) {
  if (value === false || value === null || value === undefined) {
    if (node.hasAttribute(name)) node.removeAttribute(name);
  } else {
    const written = value === true ? "" : String(value);
    if (node.getAttribute(name) !== written) node.setAttribute(name, written);
  }
}

export function text(node, value) {
  const written = value ?? "";
  if (node.textContent !== written) node.textContent = written;
}

export function show(node, visible) {
  if (node.hidden === !visible) return;
  node.hidden = !visible;
}

/** Text that is there only when there is something to say. */
export function say(node, value) {
  text(node, value);
  show(node, Boolean(value));
}

/** The value of an input, unless somebody is typing in it. */
export function value(input, wanted) {
  if (document.activeElement !== input && input.value !== wanted) input.value = wanted;
}

/**
 * Children that follow a list: `make(item)` returns `{root, draw(item)}` once per key; elements that stay keep focus
 * and what was opened in them.
 */
export function keyed(parent, key, make) {
  const known = new Map();
  return (items) => {
    const wanted = new Set(items.map(key));
    for (const [k, part] of known) {
      if (!wanted.has(k)) {
        part.root.remove();
        known.delete(k);
      }
    }
    let previous = null;
    for (const item of items) {
      const k = key(item);
      let part = known.get(k);
      if (!part) known.set(k, (part = make(item)));
      part.draw(item);
      const place = previous ? previous.nextSibling : parent.firstChild;
      if (place !== part.root) parent.insertBefore(part.root, place);
      previous = part.root;
    }
  };
}

/** A button whose text is `label`. */
export const button = (action, label, onclick, attributes = {}) =>
  el("button", { type: "button", "data-action": action, onclick, ...attributes }, label);
