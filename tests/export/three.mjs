// three.mjs CHROMIUM PAGE FOLDER GLB BIN COUNTS: loads GLB in three.js in headless Chromium, sets morph weights, and compares position and
// picture with the shapes of BIN (COUNTS: poses,dimension,vertices of its records). Prints JSON; writes FOLDER/three_N.png of both side by side.
import { createServer } from "node:http";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [executablePath, page, folder, glb, bin, counts] = process.argv.slice(2);
const modules = join(dirname(fileURLToPath(import.meta.url)), "node_modules");
const types = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript" };

const server = createServer((request, response) => {
    const path = new URL(request.url, "http://localhost").pathname;
    const file = { "/": page, "/shape.glb": glb, "/shape.bin": bin }[path] ?? join(modules, path);
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
        writeFileSync(join(folder, `three_${i}.png`), Buffer.from(picture.split(",")[1], "base64"));
    delete report.pictures;
    console.log(JSON.stringify({ ...report, said: said.filter((line) => !/GPU stall|GL Driver Message|favicon|404/.test(line)) }));
} finally {
    await browser.close();
    server.close();
}
