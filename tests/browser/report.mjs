// Operates the report of a run in Chromium: wheel, drag, buttons, slider and fingers change what they should.
// Usage: node report.mjs PHASESCAN [FOLDER for screenshots]
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { check, open, page } from "./browser.mjs";

const [phasescan, shots] = process.argv.slice(2);
const browser = await open();
const folder = mkdtempSync(join(tmpdir(), "phasescan-report-"));

function run(...words) {
  execFileSync(phasescan, words, { stdio: ["ignore", "ignore", "inherit"] });
}

/// Every fourth pixel of the map as numbers.
const picture = (at) => at.$eval("#viewer", (c) => {
  const all = c.getContext("2d").getImageData(0, 0, c.width, c.height).data, out = [];
  for (let i = 0; i < all.length; i += 16) out.push(all[i] + 256 * all[i + 1] + 65536 * all[i + 2]);
  return out;
});
const same = (a, b) => a.length === b.length && a.every((v, i) => v === b[i]);
const text = (at) => at.$eval("#viewer-text", (t) => t.textContent);
const slide = (at, to) => at.$eval("#viewer-time", (s, v) => { s.value = v; s.dispatchEvent(new Event("input")); }, to);
const shot = (at, name) => shots && at.screenshot({ path: join(shots, name + ".png"), fullPage: true });

async function desktop(url) {
  const at = await page(browser, url, 1280, 900);
  await at.waitForFunction(() => document.getElementById("viewer").width > 300);
  await at.$eval("#viewer", (c) => c.scrollIntoView({ block: "center" }));
  const box = await (await at.$("#viewer")).boundingBox(), x = box.x + box.width / 2, y = box.y + box.height / 2;
  const fit = await picture(at);
  const share = (colour) => fit.filter((v) => v === colour).length / fit.length;
  check("the map has free space and walls", share(0xfefefe) > 0.03 && share(0) > 0.002);

  await at.mouse.move(x, y);
  await at.mouse.wheel({ deltaY: -400 });
  const near = await picture(at);
  check("the wheel zooms", !same(near, fit));
  await at.mouse.down();
  await at.mouse.move(x + 80, y + 30, { steps: 4 });
  await at.mouse.up();
  const moved = await picture(at);
  check("dragging moves the map", !same(moved, near));
  await at.mouse.move(x, y);
  check("a released map stays", same(await picture(at), moved));
  await at.click("#viewer-fit");
  check("fit brings the whole map back", same(await picture(at), fit));
  await at.click("#viewer-in");
  await at.click("#viewer-out");
  const back = await picture(at);
  check("out undoes in", back.filter((v, i) => v !== fit[i]).length < 0.02 * fit.length);

  const first = await text(at);
  check("the first scan is shown", /^Scan 0 at 0\.0 s: /.test(first));
  const last = await at.$eval("#viewer-time", (s) => +s.max);
  check("there are scans to slide through", last > 50);
  await slide(at, last);
  const end = await text(at);
  check("the slider goes to the last scan", new RegExp("^Scan " + last + " at ").test(end) && /1 sigma \d+\.\d cm, \d+\.\d\d deg$/.test(end));
  check("and draws it there", !same(await picture(at), back));
  await slide(at, 0);
  check("and back", (await text(at)) === first);
  await shot(at, "report-desktop");
  await at.close();
}

async function phone(url) {
  const at = await page(browser, url, 390, 844, { touch: true });
  await at.$eval("#viewer", (c) => c.scrollIntoView({ block: "center" }));
  const wide = await at.evaluate(() => document.documentElement.scrollWidth);
  check("a phone need not scroll sideways, " + wide + " px", wide <= 392);
  const small = await at.$$eval("button", (all) => all.filter((b) => b.getBoundingClientRect().height < 32).length);
  check("buttons are large enough for a finger", small === 0);
  const box = await (await at.$("#viewer")).boundingBox(), before = await picture(at);
  const client = await at.createCDPSession();
  const fingers = (type, gap) => client.send("Input.dispatchTouchEvent", { type, touchPoints: gap === null ? [] : [-1, 1].map((side, id) =>
    ({ x: box.x + box.width / 2 + side * gap, y: box.y + box.height / 2, id })) });
  await fingers("touchStart", 30);
  for (const gap of [45, 60, 90]) await fingers("touchMove", gap);
  await fingers("touchEnd", null);
  check("two fingers zoom", !same(await picture(at), before));
  await shot(at, "report-phone");
  await at.close();
}

try {
  const log = join(folder, "log.jsonl"), out = join(folder, "out");
  run("simulate", "--world", "flat:7", "--sensor", "rplidar-a1", "--duration", "22", "--out", log);
  run("slam", log, "--out", out);
  const url = pathToFileURL(join(out, "report.html")).href;
  await desktop(url);
  await phone(url);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
