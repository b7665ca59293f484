// Numbers and names as people read them.

export const pixels = (size) => (size ? `${size[0]}x${size[1]}` : "");

/** "1920x1080", "1920 × 1080" or "1920, 1080" as two whole numbers; null for anything else. */
export function parsePixels(written) {
  const found = /^\s*(\d{1,5})\s*(?:px)?\s*[x×*,;\s]\s*(\d{1,5})\s*(?:px)?\s*$/i.exec(written);
  return found ? [Number(found[1]), Number(found[2])] : null;
}

/** Digits after the point such that σ has two that count. */
const digits = (sigma) => (sigma > 0 ? Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(sigma)))) : 2);

export function plusMinus(value, sigma) {
  if (value === null || value === undefined) return "";
  if (!(sigma > 0)) return String(Number(value.toPrecision(6)));
  const d = digits(sigma);
  return `${value.toFixed(d)} ± ${sigma.toFixed(d)}`;
}

/** With a capital letter and a full stop: messages come as clauses, too. Symbols (σ) and names of files stay as they are. */
export function sentence(clause) {
  const bare = (clause ?? "").trim();
  if (bare === "") return "";
  const begun = /^[a-z][a-z'’-]*(?=[\s,:;]|\.?$)/.test(bare) ? bare[0].toUpperCase() + bare.slice(1) : bare;
  return /[.!?…:]$/.test(begun) ? begun : `${begun}.`;
}

/** What was wrong and what to do, as one text. */
export const told = (problem) => (problem ? [problem.message, problem.advice].map(sentence).filter(Boolean).join(" ") : "");

export const degrees = (angle) => `${angle.toFixed(0).replace("-", "−").replace(/^−0$/, "0")}°`;
export const thousands = (n) => Math.round(n).toString().replace(/\B(?=(\d{3})+$)/g, " ");
export const plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;

export function bytes(n) {
  return n < 2 ** 20 ? `${Math.ceil(n / 2 ** 10)} kB` : `${(n / 2 ** 20).toFixed(1)} MB`;
}
