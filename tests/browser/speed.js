// How fast a report opens and answers: `node speed.js REPORT…`. Prints; judges nothing, as machines differ.
import { resolve } from "node:path";

import { openPage } from "./browser.js";

/** Frames a second while `move` is called before each of them, and the 95th percentile of the time between two. */
async function rate(page, move) {
    return page.evaluate(async (text) => {
        const move = new Function("i", text);
        const next = () => new Promise(requestAnimationFrame);
        const times = [];
        let last = await next();
        for (let i = 0; i < 120; i++) {
            move(i);
            const now = await next();
            times.push(now - last);
            last = now;
        }
        times.sort((a, b) => a - b);
        return { fps: 1000 / (times.reduce((a, b) => a + b) / times.length), slowest: times[Math.floor(0.95 * times.length)] };
    }, move);
}

const set = (id) => `const input = document.getElementById("${id}"); const n = Number(input.max) + 1;
    input.value = String((i * Number(input.step || 1)) % n); input.dispatchEvent(new Event("input", { bubbles: true }));`;

for (const path of process.argv.slice(2)) {
    const opened = [];
    for (let i = 0; i < 3; i++) {
        const { browser, seconds } = await openPage(resolve(path));
        opened.push(seconds);
        await browser.close();
    }
    console.log(`${path}: opens in ${opened.map((s) => s.toFixed(2)).join(", ")} s`);
    const { page, browser } = await openPage(resolve(path));
    const moves = ["spot", "column"].map((name) => [`${name} slider`, set(`explorer-${name}`), "#explorer-spot"]);
    const turn = 'document.querySelector("#bench-3d canvas").dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));';
    for (const [name, move, place] of [...moves, ["turning the bench", turn, "#bench-3d canvas"]]) {
        await page.locator(place).scrollIntoViewIfNeeded();
        const { fps, slowest } = await rate(page, move);
        console.log(`  ${name}: ${fps.toFixed(1)} frames/s, 95 % of them within ${slowest.toFixed(1)} ms`);
    }
    await browser.close();
}
