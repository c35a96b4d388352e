// three.mjs CHROMIUM PAGE FOLDER COUNTS FILE...: opens PAGE with three.js in headless Chromium, where FILE... are /file0, /file1, ... and
// COUNTS is the page's own argument. Prints the page's report, JSON, and writes its pictures, FOLDER/PAGE_N.png.
import { createServer } from "node:http";
import { readFileSync, writeFileSync } from "node:fs";
import { basename, dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [executablePath, page, folder, counts, ...files] = process.argv.slice(2);
const modules = join(dirname(fileURLToPath(import.meta.url)), "node_modules");
const types = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript" };

const server = createServer((request, response) => {
    const path = new URL(request.url, "http://localhost").pathname;
    const file = path === "/" ? page : files[path.match(/^\/file(\d+)$/)?.[1]] ?? join(modules, path);
    if (file.startsWith(modules) && (!path.startsWith("/three/") || path.includes(".."))) return response.writeHead(404).end();
    try {
        response.writeHead(200, { "Content-Type": types[extname(file)] ?? "application/octet-stream" }).end(readFileSync(file));
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));

let browser;
try {
    browser = await chromium.launch({
        executablePath,
        args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
    });
} catch (error) {
    console.log(`Chromium does not start: ${error.message.split("\n")[0]}`);
    process.exit(77);
}
try {
    const tab = await browser.newPage({ viewport: { width: 560, height: 300 } });
    const said = [];
    tab.on("console", (message) => ["error", "warning"].includes(message.type()) && said.push(message.text()));
    tab.on("pageerror", (error) => said.push(String(error)));
    await tab.goto(`http://127.0.0.1:${server.address().port}/?counts=${counts}`);
    await tab.waitForFunction(() => window.report !== undefined, null, { timeout: 80000 });
    const report = await tab.evaluate(() => window.report);
    for (const [i, picture] of report.pictures.entries())
        writeFileSync(join(folder, `${basename(page, ".html")}_${i}.png`), Buffer.from(picture.split(",")[1], "base64"));
    delete report.pictures;
    console.log(JSON.stringify({ ...report, said: said.filter((line) => !/GPU stall|GL Driver Message|favicon|404/.test(line)) }));
} finally {
    await browser.close();
    server.close();
}
