// One's own model: two copies of it collide on one tab, and the other one lints it.

import { receive } from "./files.js";
import { show, started } from "./show.js";

const [message, report, tabs] = [".message", "pre", ".tabs"].map((name) => document.querySelector(name));
/** Whether the user has brought anything, and the number of the file before the one whose verdict is waited for. */
let [any, before] = [false, null];
/** The file that was brought last, and what lints it once its tab is opened. */
let [file, panel] = [null, null];

async function bring(name, read) {
  any = true;
  const bytes = await read();
  file = { name, bytes };
  panel?.bring(name, bytes);
  await started;
  if (!show.stage) return;
  message.textContent = `Looking into ${name}`;
  message.className = "message";
  // The message is painted before the work begins; and a show that has not begun would end with a file that is no good.
  do await new Promise((then) => setTimeout(then, 50)); while (!show.state().started && !show.trouble);
  before = show.state().model.number;
  show.stage.bring(name, bytes);
}

function refuse(why) {
  message.textContent = why;
  message.className = "message trouble";
}

setInterval(() => {
  if (before === null || show.trouble) return;
  const { model } = show.state();
  if (model.number <= before || !(model.error || model.shown)) return;
  before = null;
  if (model.error) return refuse(`${model.error}.${report.textContent ? " The model before it stays." : ""}`);
  message.textContent = model.name;
  message.className = "message";
  report.textContent = model.report;
}, 250);

/** Opens a tab. Lint is loaded when its tab is opened for the first time. */
async function openTab(name) {
  for (const tab of tabs.children) tab.setAttribute("aria-pressed", String(tab.dataset.tab === name));
  for (const content of document.querySelectorAll("[data-of-tab]")) content.hidden = content.dataset.ofTab !== name;
  if (name !== "lint" || panel) return;
  const { Panel } = await import("./lint_panel.js");
  if (panel) return;
  panel = new Panel(document.querySelector("section.lint"));
  panel.report.addEventListener("load", () => listenTo(panel.report.contentWindow));
  if (file) panel.bring(file.name, file.bytes);
}
for (const tab of tabs.children) tab.addEventListener("click", () => openTab(tab.dataset.tab));

const { giveSample, listenTo } = receive({ target: document.querySelector("main"), bring, refuse });
// Something is to be seen from the start, unless the user was faster.
started.then(() => any || giveSample("dolphin_2256.glb"));
