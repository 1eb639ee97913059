// Shows avatar.html in a headless browser, and writes a picture of each of some shapes.
// node in_browser.mjs FOLDER SHAPE ...: in FOLDER are the page, avatar.glb and node_modules.
import fs from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

const [folder, ...shapes] = process.argv.slice(2);
const find = createRequire(path.join(folder, "avatar.html"));
const { default: chromium } = await import(find.resolve("@sparticuz/chromium"));
const { default: puppeteer } = await import(find.resolve("puppeteer-core"));
const kinds = { ".html": "text/html", ".js": "text/javascript" };
const server = http.createServer((request, answer) => {
  const file = path.join(folder, decodeURIComponent(request.url.split("?")[0]));
  if (!fs.existsSync(file)) {
    answer.writeHead(404).end();
    return;
  }
  answer.setHeader("content-type", kinds[path.extname(file)] ?? "application/octet-stream");
  fs.createReadStream(file).pipe(answer);
});
await new Promise((done) => { server.listen(0, done); });
const software = ["--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"];
const browser = await puppeteer.launch({
  args: [...chromium.args, "--no-sandbox", ...software],
  executablePath: await chromium.executablePath(),
  headless: "shell",
});
const page = await browser.newPage();
page.setDefaultTimeout(120000);
await page.setViewport({ width: 720, height: 520 });
const address = `http://localhost:${server.address().port}/avatar.html`;
await page.goto(address, { waitUntil: "domcontentloaded" });
await page.waitForFunction(() => document.getElementById("line").textContent !== "Loading ...");
console.log(await page.evaluate(() => document.getElementById("line").textContent));
for (const shape of shapes) {
  await page.evaluate((chosen) => {
    for (const slider of document.querySelectorAll("input")) {
      slider.value = slider.id.startsWith(chosen) ? 1 : 0;
      slider.oninput();
    }
  }, shape);
  await new Promise((done) => { setTimeout(done, 3000); });
  await page.screenshot({ path: path.join(folder, `${shape}.png`) });
}
await browser.close();
server.close();
