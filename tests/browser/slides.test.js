// The recoveries with sliders in the report of a run, in a real browser. PHICAM_RUN is its folder.
import assert from "node:assert/strict";
import { join, resolve } from "node:path";
import { after, before, describe, test } from "node:test";
import { inflateSync } from "node:zlib";

import { axe, npy, openPage, random } from "./browser.js";

const report = join(resolve(process.env.PHICAM_RUN ?? "out"), "report.html");

/** The f32 numbers of a packed block, unpacked on another way than the page's. */
function unpacked({ text, count, order }) {
    const planes = inflateSync(Buffer.from(text, "base64"));
    const words = Array.from({ length: count }, (_, i) => [0, 1, 2, 3].reduce((word, k) => word + planes[k * count + i] * 2 ** (8 * k), 0));
    for (let times = 0; times < order; times++) {
        for (let i = 1; i < count; i++) {
            words[i] = (words[i] + words[i - 1]) % 2 ** 32;
        }
    }
    const bytes = Buffer.alloc(4 * count);
    words.forEach((word, i) => bytes.writeUInt32LE(word, 4 * i));
    return words.map((_, i) => bytes.readFloatLE(4 * i));
}

/** The colour of a reflectance on the fixed scale: black 0, white 1, blue below, orange above. */
function grey(x) {
    if (Number.isNaN(x)) {
        return [0xcc, 0x79, 0xa7];
    }
    return x < 0 ? [0x00, 0x72, 0xb2] : x > 1 ? [0xd5, 0x5e, 0x00] : Array(3).fill(Math.round(255 * x));
}

describe("the recoveries with sliders", () => {
    let page, browser, errors, about, values;
    before(async () => {
        ({ page, browser, errors } = await openPage(report));
        about = await page.$eval("#slides-data", (e) => JSON.parse(e.textContent));
        values = unpacked(await page.$eval("#slides-values", (e) => ({ text: e.textContent, count: Number(e.dataset.count), order: Number(e.dataset.order) })));
    });
    after(() => browser?.close());

    /** What is set and shown now. */
    const state = () =>
        page.$eval("#slides", (element) => {
            const colours = (name) => {
                const canvas = element.querySelector(`[data-show="${name}"]`);
                return [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data];
            };
            const text = (name) => element.querySelector(`[data-show="${name}"]`).textContent;
            const control = (name) => element.querySelector(`[name="${name}"]`);
            return {
                method: control("method").selectedIndex,
                step: Number(control("step").value),
                spoken: control("step").getAttribute("aria-valuetext"),
                noise: Number(control("noise").value),
                automatic: control("automatic").checked,
                picture: colours("picture"),
                truth: colours("truth"),
                read: Object.fromEntries(["raw", "normalized", "correlation", "rmse"].map((name) => [name, text(name)])),
            };
        });
    const set = async (name, value) => {
        await page.$eval(
            `#slides [name="${name}"]`,
            (control, to) => {
                control.type === "checkbox" ? (control.checked = to) : (control.value = String(to));
                control.dispatchEvent(new Event("input", { bubbles: true }));
            },
            value,
        );
    };
    /** The colours that values ask for, the last row of elements on top. */
    const colours = (first, [nu, nv]) =>
        Array.from({ length: nu * nv }, (_, at) => [...grey(values[first + (at % nu) + (nv - 1 - Math.floor(at / nu)) * nu]), 255]).flat();

    test("every picture is there once, and none too many", () => {
        const places = about.series.flatMap((s) => s.pictures.flat()).filter((p) => p !== null);
        assert.deepEqual(places.toSorted((a, b) => a - b), places.map((_, i) => i + 1));
        assert.equal(values.length, about.elements * (places.length + 1));
    });

    test("without noise, the automatic pictures are what the run recovered", () => {
        const { name, first, elements: [nu, nv] } = about.surfaces[0];
        for (const { method, automatic, pictures } of about.series) {
            const recovered = npy(join(resolve(process.env.PHICAM_RUN ?? "out"), "recovered", `${method}.npy`));
            assert.deepEqual(recovered.shape, [nv, nu]);
            const from = pictures[0][automatic[0].step] * about.elements + first;
            const truth = Array.from({ length: nu * nv }, (_, at) => recovered.at(Math.floor(at / nu), at % nu));
            // Both add up the same inversion in another order. That of `pinv` has a condition of 1e13, which makes of rounding, 1.1e-16, 1e-3 of the largest value.
            const exact = Math.max(...truth.map(Math.abs)) * (method === "pinv" ? 1e13 * 1.1e-16 : 1e-6);
            truth.forEach((value, at) => {
                assert.ok(Math.abs(values[from + at] - value) <= exact, `${method} of ${name}, ${at}: ${values[from + at]}, ${value}`);
            });
        }
    });

    test("what is shown is what the data hold, at 40 random places and at every automatic one", async () => {
        const next = random(4);
        const some = (n) => Math.floor(next() * n);
        const places = Array.from({ length: 40 }, () => {
            const method = some(about.series.length);
            return { method, step: some(about.series[method].steps.length), noise: some(about.noises.length) };
        });
        const surface = about.surfaces[0];
        for (const { method, step, noise } of places) {
            await set("method", method);
            await set("noise", noise);
            await set("step", step);
            const now = await state();
            assert.deepEqual([now.method, now.step, now.noise, now.automatic], [method, step, noise, false]);
            const place = about.series[method].pictures[noise][step];
            const expected = place === null ? Array(surface.elements[0] * surface.elements[1]).fill([...grey(NaN), 255]).flat() : colours(place * about.elements + surface.first, surface.elements);
            assert.deepEqual(now.picture, expected, `${about.series[method].method}, step ${step}, noise ${noise}`);
            assert.deepEqual(now.truth, colours(surface.first, surface.elements));
        }
        await set("automatic", true);
        for (const [method, series] of about.series.entries()) {
            for (const [noise, chosen] of series.automatic.entries()) {
                await set("method", method);
                await set("noise", noise);
                const now = await state();
                assert.ok(now.automatic);
                if (chosen.step !== undefined) {
                    assert.equal(now.step, chosen.step);
                    const rmse = series.measures[noise][chosen.step][0][3];
                    assert.ok(Math.abs(Number(now.read.rmse.replace(/\u202f×\u202f10(.*)/, (_, p) => `e${[...p].map((c) => (c === "⁻" ? "-" : "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c))).join("")}`)) - rmse) <= 0.0051 * rmse, `${now.read.rmse} is not ${rmse}`);
                }
            }
        }
    });

    test("the keyboard alone changes the picture", async () => {
        await set("method", about.series.findIndex((s) => s.method === "tikhonov"));
        await set("noise", 0);
        await page.focus("#slides-step");
        await page.keyboard.press("Home");
        const strong = await state();
        await page.keyboard.press("End");
        const weak = await state();
        assert.deepEqual([strong.step, weak.automatic], [0, false]);
        assert.notDeepEqual(strong.picture, weak.picture);
        assert.match(strong.spoken, /damping/);
        assert.notEqual(strong.spoken, weak.spoken);
        await page.focus('#slides [name="automatic"]');
        await page.keyboard.press("Space");
        const automatic = await state();
        assert.ok(automatic.automatic && automatic.step === about.series[automatic.method].automatic[0].step);
        await page.focus("#slides-noise");
        await page.keyboard.press("End");
        const loud = await state();
        assert.equal(loud.noise, about.noises.length - 1);
        assert.notDeepEqual(loud.picture, automatic.picture);
        await page.focus('#slides [name="stretched"]');
        await page.keyboard.press("Space");
        const stretched = await state();
        assert.notDeepEqual(stretched.picture, loud.picture);
        assert.deepEqual(stretched.truth, loud.truth);
        // Stretched, the picture has its black and its white, and nothing outside.
        const reds = stretched.picture.filter((_, i) => i % 4 === 0);
        assert.deepEqual([Math.min(...reds), Math.max(...reds)], [0, 255]);
        await page.keyboard.press("Space");
    });

    test("axe-core finds no serious violation", async () => assert.deepEqual(await axe(page), []));

    test("no error came", () => assert.deepEqual(errors, []));
});
