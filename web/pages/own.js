// One's own model: dropped on the page or chosen, and never sent anywhere.

import { show, started } from "./show.js";

/** More than this does not fit into a page's memory together with all that is made of it. */
const LARGEST = 256e6;

const stage = document.querySelector(".stage");
const [message, report] = [".message", "pre"].map((name) => document.querySelector(name));
/** Whether the user has brought anything, and the number of the file before the one whose verdict is waited for. */
let [any, before] = [false, null];

async function bring(name, bytes) {
  message.textContent = `Looking into ${name}`;
  message.className = "message";
  // The message is painted before the work begins; and a show that has not begun would end with a file that is no good.
  do await new Promise((then) => setTimeout(then, 50)); while (!show.state().started && !show.trouble);
  before = show.state().model.number;
  show.stage.bring(name, bytes);
}

async function bringFile(file) {
  if (!file) return;
  any = true;
  await started;
  if (!show.stage) return;
  if (file.size > LARGEST) return refuse(`${file.name}: ${(file.size / 1e6).toFixed(0)} MB are more than a page can take; the largest are ${LARGEST / 1e6} MB.`);
  try {
    await bring(file.name, new Uint8Array(await file.arrayBuffer()));
  } catch (error) {
    refuse(`${file.name}: ${error.message ?? error}`);
  }
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

for (const [event, over] of [["dragenter", true], ["dragover", true], ["dragleave", false], ["drop", false]]) {
  addEventListener(event, (detail) => {
    detail.preventDefault();
    stage.classList.toggle("dropping", over);
  });
}
addEventListener("drop", (event) => bringFile(event.dataTransfer?.files[0]));

const chooser = document.querySelector("input[type=file]");
chooser.addEventListener("change", () => {
  bringFile(chooser.files[0]);
  // The same file may be chosen again, when it has been changed.
  chooser.value = "";
});

async function bringSample(name) {
  await started;
  if (!show.stage) return;
  try {
    const response = await fetch(`assets/${name}`);
    if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
    await bring(name, new Uint8Array(await response.arrayBuffer()));
  } catch (error) {
    refuse(`${name}: ${error.message ?? error}`);
  }
}

for (const button of document.querySelectorAll("button[data-sample]")) {
  button.addEventListener("click", () => bringSample(button.dataset.sample));
}
// Something is to be seen from the start, unless the user was faster.
started.then(() => any || bringSample("dolphin_2256.glb"));
