// A folder served to a headless browser, and one tab in it: what page.mjs and page_cost.mjs share.
import { createServer } from "node:http";
import { existsSync, readFileSync } from "node:fs";
import { extname, join } from "node:path";
import puppeteer from "puppeteer-core";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

export function serve(folder) {
  const asked = [];
  const server = createServer((request, response) => {
    const path = new URL(request.url, "http://page").pathname.replace(/\/$/, "/index.html"), file = join(folder, path);
    asked.push(path);
    if (!existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
    response.end(readFileSync(file));
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done({ server, asked, port: server.address().port })));
}

export function launch(browserPath) {
  if (browserPath.includes("firefox")) // WebGL there needs a display: the test runs this under xvfb-run
    return puppeteer.launch({ browser: "firefox", executablePath: browserPath, headless: false });
  return puppeteer.launch({ executablePath: browserPath, headless: true,
                            args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
}

export const settled = (tab) => tab.waitForFunction(() => window.page?.asset && !window.page.needsBlend && !window.page.timer,
                                             { timeout: 60000 });

// A page of its own each time: the same page with another part behind '#' would not be loaded again, and still show what it
// showed before.
export async function open(tab, port, hash) {
  await tab.goto("about:blank");
  await tab.goto(`http://127.0.0.1:${port}/${hash}`);
  await settled(tab);
}
