// node explorer_bench.mjs PAGE [CHROMIUM]: updates per second of the page of `softfinger explore`, whose load slider
// moves at each of the browser's frames. In real time, at both widths: at 60 frames a second, as screens
// show them, and with as many as the browser can draw. Fails where the page writes errors to the console.
import {spawn} from "node:child_process";
import {mkdtempSync, rmSync} from "node:fs";
import {tmpdir} from "node:os";
import {join, resolve} from "node:path";

const [page, chromium = "chromium"] = process.argv.slice(2);
const SECONDS = 4;

// Chromium's debugging protocol through a pipe: JSON, a zero after each message.
function browser(flags) {
  const profile = mkdtempSync(join(tmpdir(), "explorer_bench_"));
  const process_ = spawn(chromium, ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe",
    `--user-data-dir=${profile}`, ...flags, "about:blank"], {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
  const waiting = new Map(), listeners = [];
  let last = 0, rest = "";
  process_.stdio[4].setEncoding("utf8").on("data", (text) => {
    const messages = (rest + text).split("\0");
    rest = messages.pop();
    for (const message of messages.map((one) => JSON.parse(one))) {
      if (!message.id) listeners.forEach((listen) => listen(message));
      else if (message.error) waiting.get(message.id).reject(new Error(message.error.message));
      else waiting.get(message.id).resolve(message.result);
    }
  });
  const send = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
    waiting.set(++last, {resolve, reject});
    process_.stdio[3].write(JSON.stringify({id: last, method, params, sessionId}) + "\0");
  });
  const close = async () => {
    const gone = new Promise((resolve) => process_.once("exit", resolve));
    await send("Browser.close");
    await gone;
    rmSync(profile, {recursive: true, force: true});
  };
  return {send, listeners, close};
}

// Runs in the page.
async function slide(seconds) {
  const slider = document.getElementById("P"), verdict = document.getElementById("verdict");
  const start = performance.now();
  let frames = 0, updates = 0, shown = verdict.textContent;
  while (performance.now() - start < 1000 * seconds) {
    slider.value = String(250 + (37 * ++frames) % 500);
    slider.dispatchEvent(new Event("input"));
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    updates += verdict.textContent !== shown;
    shown = verdict.textContent;
  }
  return {updates, rate: updates / ((performance.now() - start) / 1000)};
}

async function measure(width, height, flags) {
  const {send, listeners, close} = browser(flags), errors = [];
  try {
    listeners.push(({method, params}) => {
      if (method === "Runtime.exceptionThrown") errors.push(params.exceptionDetails.text);
      if (method === "Runtime.consoleAPICalled" && params.type === "error") errors.push(JSON.stringify(params.args));
      if (method === "Log.entryAdded" && params.entry.level === "error") errors.push(params.entry.text);
    });
    const {targetId} = await send("Target.createTarget", {url: "about:blank"});
    const {sessionId} = await send("Target.attachToTarget", {targetId, flatten: true});
    const run = async (expression) => {
      const {result, exceptionDetails} = await send("Runtime.evaluate", {expression, awaitPromise: true, returnByValue: true}, sessionId);
      if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    };
    for (const domain of ["Runtime", "Log", "Page"]) await send(`${domain}.enable`, {}, sessionId);
    await send("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: 1, mobile: width < 600}, sessionId);
    await send("Page.navigate", {url: `file://${resolve(page)}`}, sessionId);
    for (let i = 0; (await run("document.documentElement?.dataset.timed")) !== "true"; ++i) {
      if (i === 200) throw new Error("the page does not get ready");
      await new Promise((wake) => setTimeout(wake, 50));
    }
    // The processor time of the page's own thread, which other programs do not lengthen.
    const worked = async () => {
      const {metrics} = await send("Performance.getMetrics", {}, sessionId);
      return metrics.find(({name}) => name === "TaskDuration").value;
    };
    await send("Performance.enable", {timeDomain: "threadTicks"}, sessionId);
    const before = await worked(), result = await run(`(${slide})(${SECONDS})`);
    result.processor_ms = 1e3 * (await worked() - before) / result.updates;
    if (errors.length) throw new Error(`errors in the console: ${errors.join("; ")}`);
    if ((await run("document.documentElement.scrollWidth")) > width) throw new Error(`wider than ${width} pixels`);
    return result;
  } finally {
    await close();
  }
}

for (const [width, height] of [[1280, 900], [390, 844]])
  for (const [words, flags] of [["60 frames a second", []], ["no limit", ["--disable-frame-rate-limit", "--disable-gpu-vsync"]]]) {
    const {rate, processor_ms} = await measure(width, height, flags);
    console.log(`${width} pixels, ${words}: ${rate.toFixed(1)} updates a second, ${processor_ms.toFixed(1)} ms of processor time each`);
  }
