// Lints one file and ends.

import init, { lint } from "./checks.js";

/** Milliseconds between two messages about progress. */
const PATIENCE = 50;

let last = { what: null, time: 0 };
let panic = null;
const audience = {
  progress(what, done, all) {
    const time = performance.now();
    if (what === last.what && time - last.time < PATIENCE) return;
    last = { what, time };
    postMessage({ progress: { what, done, all } });
  },
  warning(warning) {
    postMessage({ warning });
  },
  panicked(text) {
    panic = text;
  },
};

addEventListener("message", async ({ data: { name, bytes, options } }) => {
  try {
    await init();
    const start = performance.now();
    const report = lint(name, bytes, ...options, audience);
    const { html, findings, shapes } = report;
    postMessage({ report: { html, findings, shapes, seconds: (performance.now() - start) / 1000 } });
  } catch (error) {
    // A message of lint is a string. Otherwise the program stopped, or is not there.
    postMessage({ error: typeof error === "string" ? error : stopped(name, error) });
  }
});

function stopped(name, error) {
  if (panic) return `${name}: the program has a bug, please report it: ${panic}`;
  if (error instanceof WebAssembly.RuntimeError) return `${name}: the program stopped, probably because the browser gives it no more memory (${error.message})`;
  return `${name}: the program cannot be started: ${error.message ?? error}`;
}
