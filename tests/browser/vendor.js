// Makes src/report/page/vendor from the packages of package-lock.json; `--check` says whether the folder is what would be made.
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const here = import.meta.dirname;
const vendor = join(here, "../../src/report/page/vendor");
const require = createRequire(import.meta.url);

/** What a page uses of each library. */
const libraries = [
    {
        file: "plot.min.js",
        name: "Plot",
        source: `export { areaY, dot, frame, gridX, gridY, line, plot } from "@observablehq/plot";`,
    },
    {
        file: "three.min.js",
        name: "THREE",
        source: `export {
            AmbientLight, BackSide, BufferAttribute, BufferGeometry, Color, DataTexture, DirectionalLight, DoubleSide, EdgesGeometry,
            Float32BufferAttribute, FrontSide, Group, LinearFilter, LinearMipmapLinearFilter, Matrix4, Mesh, MeshBasicMaterial,
            MeshLambertMaterial, NearestFilter, OrthographicCamera, Points, PointsMaterial, Quaternion, RepeatWrapping, SRGBColorSpace, Scene,
            Vector3, WebGLRenderer,
        } from "three";
        export { OrbitControls } from "three/addons/controls/OrbitControls.js";
        export { LineMaterial } from "three/addons/lines/LineMaterial.js";
        export { LineSegments2 } from "three/addons/lines/LineSegments2.js";
        export { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";`,
    },
];

/** The packages whose code got into a bundle, by esbuild's own list. */
const packages = ({ outputs }) => {
    const inputs = Object.values(outputs).flatMap((o) => Object.entries(o.inputs));
    const used = inputs.filter(([, { bytesInOutput }]) => bytesInOutput > 0);
    const names = used.map(([path]) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1]);
    return [...new Set(names.filter((name) => name !== undefined))].sort();
};

const folder = (name) => {
    const paths = require.resolve.paths(name) ?? [];
    const found = paths.map((path) => join(path, name)).find((path) => {
        try {
            readFileSync(join(path, "package.json"));
            return true;
        } catch {
            return false;
        }
    });
    if (found === undefined) {
        throw new Error(`no package ${name}: npm ci`);
    }
    return found;
};

const licence = (name) => {
    const at = folder(name);
    const { version, license } = JSON.parse(readFileSync(join(at, "package.json"), "utf8"));
    const text = ["LICENSE", "LICENSE.md", "LICENSE.txt"].map((file) => {
        try {
            return readFileSync(join(at, file), "utf8");
        } catch {
            return undefined;
        }
    }).find((found) => found !== undefined);
    if (text === undefined) {
        throw new Error(`${name} has no licence text`);
    }
    return { name, version, license, text: text.replaceAll("\r\n", "\n").trim() };
};

const files = new Map();
const licences = [];
for (const { file, name, source } of libraries) {
    const made = await build({
        stdin: { contents: source, resolveDir: here },
        bundle: true,
        minify: true,
        format: "iife",
        globalName: name,
        target: "es2022",
        charset: "utf8",
        legalComments: "none",
        metafile: true,
        write: false,
        logLevel: "error",
    });
    const inside = packages(made.metafile).map(licence);
    const head = inside.map((p) => `${p.name} ${p.version} (${p.license})`).join(", ");
    // What would end the element that holds the script is written otherwise.
    const text = made.outputFiles[0].text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
    files.set(file, `/* ${head}. Licences: LICENSES.txt of phicam's report/page/vendor. */\n${text}`);
    licences.push(...inside);
}
const all = licences.filter((p, i) => licences.findIndex((q) => q.name === p.name) === i);
files.set(
    "LICENSES.txt",
    `Libraries inside of phicam's pages, bundled by tests/browser/vendor.js.\n\n${all
        .map((p) => `${"=".repeat(78)}\n${p.name} ${p.version}, ${p.license}\n${"=".repeat(78)}\n${p.text}\n`)
        .join("\n")}`,
);

if (process.argv.includes("--check")) {
    const other = [...files].filter(([file, text]) => readFileSync(join(vendor, file), "utf8") !== text);
    if (other.length > 0) {
        console.error(`not what the packages give: ${other.map(([file]) => file).join(", ")}; run npm run vendor`);
        process.exit(1);
    }
    console.log(`${files.size} files are what the packages give`);
} else {
    for (const [file, text] of files) {
        writeFileSync(join(vendor, file), text);
        console.log(`${file}: ${text.length} characters`);
    }
}
