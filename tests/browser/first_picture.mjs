// How long it takes from the start of `live --demo` to its first picture, and from opening the page. Prints one line.
// Usage: node first_picture.mjs PHASESCAN [TIMES]
import { spawn } from "node:child_process";
import { open } from "./browser.mjs";

const [phasescan, times = "5"] = process.argv.slice(2);
const browser = await open();
const from_start = [], from_opening = [];
for (let i = 0; i < +times; ++i) {
  const at = await browser.newPage(), began = performance.now();
  const child = spawn(phasescan, ["live", "--demo", "--serve", "127.0.0.1:0"], { stdio: ["ignore", "ignore", "pipe"] });
  const url = await new Promise((resolve) => child.stderr.on("data", (data) => {
    const found = String(data).match(/open (http:\S+)/);
    if (found) resolve(found[1]);
  }));
  const opened = performance.now();
  await at.goto(url);
  await at.waitForFunction(() => phasescan.view.frames > 0, { polling: 5 });
  from_start.push(performance.now() - began);
  from_opening.push(performance.now() - opened);
  await at.close();
  child.kill("SIGINT");
  await new Promise((done) => child.once("exit", done));
}
const worst = (all) => Math.max(...all).toFixed(0);
const middle = (all) => all.sort((a, b) => a - b)[all.length >> 1].toFixed(0);
console.log(`first picture, ${times} times: ${middle(from_start)} ms after the start (worst ${worst(from_start)}), ${middle(from_opening)} ms after the page is opened (worst ${worst(from_opening)})`);
await browser.close();
