// The same bits as elsewhere: every scene's hashes, worked out here.

import init, { Answers } from "./checks.js";
import { lacking, load } from "./load.js";

const [what, bar, rows] = [".what", "progress", "tbody"].map((name) => document.querySelector(name));

/** What a test may ask. */
const answers = { done: false, differences: null, scenes: 0, trouble: null };
window.answers = answers;

function stop(trouble) {
  answers.trouble = String(trouble);
  what.textContent = answers.trouble;
  what.className = "what trouble";
  bar.hidden = true;
}
addEventListener("error", (event) => stop(event.message));
addEventListener("unhandledrejection", (event) => stop(event.reason?.message ?? event.reason));

async function run() {
  const lack = lacking({ drawing: false });
  if (lack) return stop(lack);
  await load({ program: "checks_bg.wasm", init }, [], what, bar);
  const test = new Answers();
  bar.max = test.count;
  for (let i = 0; i < test.count; i += 1) {
    what.textContent = `Scene ${i + 1} of ${test.count}`;
    bar.value = i;
    // The row is painted before the next scene.
    await new Promise((then) => setTimeout(then, 20));
    const line = test.next();
    const row = rows.insertRow();
    const fields = line.split(" ");
    row.insertCell().textContent = fields.slice(7).join(" ");
    row.insertCell().textContent = fields.slice(1, 7).map((hash) => hash.slice(0, 6)).join(" ");
  }
  bar.hidden = true;
  answers.scenes = test.count;
  answers.differences = test.differences();
  answers.done = true;
  what.textContent = answers.differences.length === 0
    ? `All ${test.count} scenes have the bits that every other machine has.`
    : `${answers.differences.length} differ: ${answers.differences.join("; ")}`;
  what.className = answers.differences.length === 0 ? "what" : "what trouble";
}

await run();
