// The user's own model: dropped on the page or chosen, and never sent anywhere. And the samples of the site.

/** More than this does not fit into a page's memory together with all that is made of it. */
const LARGEST = 256e6;

/**
 * Passes every file that is dropped on the page, chosen, or asked for with a sample's button to `bring(name, read)`, and reasons against one to
 * `refuse`. `target` shows that files can be dropped. Of the result, `giveSample` brings a sample, and `listenTo` accepts files that are dropped on a
 * frame of the page.
 */
export function receive({ target, bring, refuse }) {
  async function give(name, read) {
    try {
      await bring(name, read);
    } catch (error) {
      refuse(`${name}: ${error.message ?? error}`);
    }
  }

  function giveFile(file) {
    if (!file) return;
    give(file.name, async () => {
      if (file.size > LARGEST) throw new Error(`${(file.size / 1e6).toFixed(0)} MB are more than a page can take; the largest are ${LARGEST / 1e6} MB.`);
      return new Uint8Array(await file.arrayBuffer());
    });
  }

  function giveSample(name) {
    return give(name, async () => {
      const response = await fetch(`assets/${name}`);
      if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
      return new Uint8Array(await response.arrayBuffer());
    });
  }

  function listenTo(page) {
    for (const [event, over] of [["dragenter", true], ["dragover", true], ["dragleave", false], ["drop", false]]) {
      page.addEventListener(event, (detail) => {
        detail.preventDefault();
        target.classList.toggle("dropping", over);
      });
    }
    page.addEventListener("drop", (event) => giveFile(event.dataTransfer?.files[0]));
  }
  listenTo(window);

  const chooser = document.querySelector("input[type=file]");
  chooser.addEventListener("change", () => {
    giveFile(chooser.files[0]);
    // The same file may be chosen again, when it has been changed.
    chooser.value = "";
  });

  for (const button of document.querySelectorAll("button[data-sample]")) {
    button.addEventListener("click", () => giveSample(button.dataset.sample));
  }
  return { giveSample, listenTo };
}
