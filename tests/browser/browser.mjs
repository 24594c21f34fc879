// What the tests in a real browser share: Debian's Chromium by puppeteer-core, pages that may ask the network for nothing,
// and the exit code 77 with one line where either is missing.
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const modules = process.env.INTEROP_MODULES ?? join(here, "../../build/interop");
const chromium = process.env.CHROMIUM ?? "/usr/bin/chromium";

function skip(why) {
  console.log("skipped: " + why);
  process.exit(77);
}

export async function open() {
  if (!existsSync(chromium)) skip(chromium + " is missing ($CHROMIUM)");
  if (!existsSync(join(modules, "node_modules/puppeteer-core"))) skip(modules + " holds no node_modules with puppeteer-core ($INTEROP_MODULES)");
  const puppeteer = createRequire(join(modules, "/"))("puppeteer-core");
  return puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-gpu", "--force-color-profile=srgb"] });
}

export function check(what, right) {
  if (!right) {
    console.error("wrong: " + what);
    process.exitCode = 1;
  }
}

/// A page of a given size; what goes wrong in it, and what it asks of the network, is a failure.
export async function page(browser, url, width, height, options = {}) {
  const made = await browser.newPage();
  await made.setViewport({ width, height, hasTouch: options.touch ?? false, isMobile: options.touch ?? false });
  made.on("pageerror", (error) => check("script: " + error.message, false));
  made.on("console", (message) => message.type() === "error" && !options.expects?.test(message.text()) && check("console: " + message.text(), false));
  made.on("request", (request) => {
    const to = request.url();
    check("asks for " + to, to === url || to.startsWith("data:") || (options.from && to.startsWith(options.from)));
  });
  await made.goto(url);
  return made;
}
