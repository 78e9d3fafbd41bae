// The same report over `phicam serve`, every entry read from the matrices. PHICAM is the program, PHICAM_RUN the folder of a run.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { copyFileSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, describe, test } from "node:test";

import { close, npy, openPage, random } from "./browser.js";

const program = process.env.PHICAM ?? join(import.meta.dirname, "../../target/debug/phicam");
const run = resolve(process.env.PHICAM_RUN ?? "out");

/** A server of a folder, and its address. */
async function serve(folder) {
    const server = spawn(program, ["serve", folder, "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
    for await (const text of server.stdout.iterator({ destroyOnReturn: false })) {
        const address = /http:\S+/.exec(String(text))?.[0];
        if (address !== undefined) {
            return { address, stop: () => server.kill("SIGINT") };
        }
    }
    throw new Error("the server ended");
}

/** Chooses an entry by the sliders and waits for its numbers. */
async function entry(page, spot, column, row, columns) {
    await page.evaluate(
        (values) => {
            for (const [id, value] of Object.entries(values)) {
                const input = document.getElementById(id);
                input.value = String(value);
                input.dispatchEvent(new Event("input", { bubbles: true }));
            }
        },
        { "explorer-spot": spot, "explorer-column": column, "explorer-row": row },
    );
    await page.waitForFunction(
        ([s, p]) => {
            const body = document.querySelector(".readout tbody");
            return body?.dataset.spot === String(s) && body?.dataset.pixel === String(p);
        },
        [spot, column + row * columns],
    );
    return page.$$eval(".readout data", (all) => Object.fromEntries(all.map((d) => [d.dataset.of, Number(d.value)])));
}

for (const [what, files, names] of [
    ["a run", undefined, ["traced", "standard error", "modelled", "z", "doubt"]],
    ["a folder without a report", ["scene.toml", "run.json", "phi.npy", "phi.stderr.npy"], ["traced", "standard error"]],
]) {
    describe(`${what}, served`, () => {
        let server, page, errors, about;
        const bare = mkdtempSync(join(tmpdir(), "phicam-serve-"));
        before(async () => {
            files?.forEach((file) => copyFileSync(join(run, file), join(bare, file)));
            server = await serve(files === undefined ? run : bare);
            // What lies in the page is not what is shown: it comes without, and the numbers are the same.
            const without = (/** @type {string} */ html) => html.replaceAll(/<script type="application\/octet-stream" id="phi-[^<]*<\/script>/g, "");
            ({ page, errors } = await openPage(server.address, { rewrite: without }));
            assert.equal(await page.$("[id^=phi-]"), null);
            about = await page.$eval("#explorer-data", (e) => JSON.parse(e.textContent));
        });
        after(async () => {
            await close();
            server?.stop();
            rmSync(bare, { recursive: true, force: true });
        });

        test("20 random entries are those of the matrices on disk", async () => {
            const paths = { traced: "phi.npy", "standard error": "phi.stderr.npy", modelled: "model/phi.npy", z: "model/z.npy", doubt: "phi.tails.npy" };
            const matrices = Object.fromEntries(names.map((name) => [name, npy(join(run, paths[name]))]));
            const next = random(5);
            for (let i = 0; i < 20; i++) {
                const spot = Math.floor(next() * about.spots);
                const [column, row] = [Math.floor(next() * about.columns), Math.floor(next() * about.rows)];
                const shown = await entry(page, spot, column, row, about.columns);
                for (const [name, matrix] of Object.entries(matrices)) {
                    assert.equal(shown[name], matrix.at(column + row * about.columns, spot), `${name}, spot ${spot}, column ${column}, row ${row}`);
                }
            }
        });

        test("it asked the server and nobody else, without an error", async () => {
            const asked = await page.evaluate(() => performance.getEntriesByType("resource").map((r) => r.name));
            assert.ok(asked.some((name) => name.includes("/api/frame?")), asked.join("\n"));
            assert.ok(asked.every((name) => name.startsWith(server.address)), asked.join("\n"));
            assert.deepEqual(errors, []);
        });
    });
}
