// Downloads what a page needs, with a bar that knows how much is to come, and starts a program.

/** A module of one function that makes a vector of zeros: where it is no module, there are no vector instructions. */
const VECTORS = new Uint8Array([
  0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00, // the head of every module
  0x01, 0x05, 0x01, 0x60, 0x00, 0x01, 0x7b, // a type: nothing to v128
  0x03, 0x02, 0x01, 0x00, // a function of it
  0x0a, 0x08, 0x01, 0x06, 0x00, 0x41, 0x00, 0xfd, 0x0f, 0x0b, // i32.const 0, i8x16.splat
]);

/** What this browser lacks, in words for its user; null if it lacks nothing. */
export function lacking({ drawing }) {
  if (typeof WebAssembly !== "object" || !WebAssembly.validate(VECTORS)) {
    return "This page needs WebAssembly with vector instructions (SIMD), which this browser does not have. Any browser of the last few years does.";
  }
  if (drawing && !document.createElement("canvas").getContext("webgl2")) {
    return "This page draws with WebGL 2, which this browser does not have or has switched off. Another browser may have it; on a computer without a graphics card, look for “hardware acceleration” in the settings.";
  }
  return null;
}

/** Downloads files and tells `progress` how many bytes of how many are there; what each file is long says sizes.json. */
async function download(names, progress) {
  const sizes = await (await get("sizes.json")).json();
  const total = names.reduce((sum, name) => sum + (sizes[name]?.raw ?? 0), 0);
  let here = 0;
  return Promise.all(names.map(async (name) => {
    const response = await get(name);
    const parts = [];
    for (const reader = response.body.getReader(); ;) {
      const { done, value } = await reader.read();
      if (done) break;
      parts.push(value);
      here += value.length;
      progress(here, total);
    }
    return new Uint8Array(await new Blob(parts).arrayBuffer());
  }));
}

async function get(name) {
  const response = await fetch(name).catch((error) => { throw new Error(`${name}: ${error.message}`); });
  if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
  return response;
}

/** Downloads a program and these files, and starts the program with `init`; the files' bytes. How far that is, `what` says in words and `bar` shows. */
export async function load({ program, init }, files, what, bar) {
  const megabytes = (bytes) => (bytes / 1e6).toFixed(1);
  let failed = false;
  const progress = (here, total) => {
    // Other files may still be coming when one has failed.
    if (failed) return;
    bar.max = total;
    bar.value = here;
    what.textContent = here < total ? `${megabytes(here)} of ${megabytes(total)} MB` : "Starting";
  };
  try {
    const [bytes, ...rest] = await download([program, ...files], progress);
    await init({ module_or_path: bytes });
    return rest;
  } catch (error) {
    failed = true;
    throw error;
  }
}
