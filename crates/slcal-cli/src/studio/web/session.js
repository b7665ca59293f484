// The way in: the token in the address is exchanged once for a cookie that scripts cannot read.

const REMEMBERED = "slcal-studio-role";

/** An error of the server, or one of the page in the same form: code, message, advice. */
export class Problem extends Error {
  constructor({ code, message, advice }) {
    super(message);
    this.code = code;
    this.advice = advice ?? "";
  }
}

const GET_IN = new Problem({
  code: "no-session",
  message: "This page has no access to the studio.",
  advice: "Open the address that slcal studio printed in the terminal, with everything after the #.",
});

const UNREACHABLE = new Problem({
  code: "unreachable",
  message: "The studio does not answer.",
  advice: "Start slcal studio again, in the same folder, and open the address that it prints.",
});

export async function problemOf(response) {
  const body = await response.json().catch(() => null);
  return new Problem(body?.error ?? { code: `http-${response.status}`, message: `The studio answered with ${response.status}.` });
}

/** An address with the role that this page has, so that several pages of one browser are not mixed up. */
export function withRole(path, role, more = {}) {
  const url = new URL(path, location.origin);
  for (const [name, value] of Object.entries({ as: role, ...more })) url.searchParams.set(name, value);
  return url.pathname + url.search;
}

async function request(path, options) {
  try {
    return await fetch(path, { cache: "no-store", credentials: "same-origin", ...options });
  } catch {
    throw UNREACHABLE;
  }
}

/** The token of the address; it is taken out of it, so that it stays neither in the history nor on a screenshot. */
function takeToken() {
  const token = decodeURIComponent(location.hash.slice(1));
  if (token) history.replaceState(null, "", location.pathname + location.search);
  return token;
}

// Private windows may refuse storage; the role is then guessed again after a reload.
function remembered() {
  try {
    return sessionStorage.getItem(REMEMBERED);
  } catch {
    return null;
  }
}

function remember(role) {
  try {
    sessionStorage.setItem(REMEMBERED, role);
  } catch {
    // Only a convenience.
  }
}

/** The role that this page has among `roles`, or a Problem that says how to get in. */
export async function enter(roles) {
  const token = takeToken();
  if (token) {
    const response = await request("/api/session", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ token }),
    });
    if (!response.ok) {
      const problem = await problemOf(response);
      throw new Problem({ code: problem.code, message: problem.message, advice: problem.advice || GET_IN.advice });
    }
    const { role } = await response.json();
    if (roles.includes(role)) {
      remember(role);
      return role;
    }
    // The right key at the wrong door.
    const doors = { operator: "/", watcher: "/", display: "/display", camera: "/camera" };
    location.replace(doors[role] ?? "/");
    return new Promise(() => {});
  }
  const before = remembered();
  for (const role of [...roles].sort((a, b) => Number(b === before) - Number(a === before))) {
    const response = await request(withRole("/api/state", role));
    if (response.ok) {
      remember(role);
      return role;
    }
  }
  throw GET_IN;
}

/** Whether the cookie still counts: true, false, or null where nobody answers. */
export async function stillIn(role) {
  try {
    return (await request(withRole("/api/state", role))).ok;
  } catch {
    return null;
  }
}
