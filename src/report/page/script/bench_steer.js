// Buttons, keys, wheel and tick boxes of the bench.

const STEERING_KEYS =
    "Drag, or the arrow keys, turn the bench; + and − zoom, Shift with an arrow key moves it, Home starts again. The wheel zooms once the drawing is clicked; with " +
    "fingers: sideways turns, two zoom and move, up and down scrolls the page. A click or tap on a spot, or on the wall inside the camera's view, chooses it. Walls, and the object's " +
    "back, are drawn as if they let light through, so that what is behind them shows.";

/** A turn by key or button, radians; a step of zoom; a move, CSS pixels. */
const STEP = { turn: Math.PI / 36, zoom: 1.15, move: 24 };

/** What is shown and hidden together. @type {{ part: Part, text: string, ink: Ink }[]} */
const PARTS = [
    { part: "walls", text: "walls (relay)", ink: "walls" },
    { part: "object", text: "object (hidden)", ink: "object" },
    { part: "obstacles", text: "obstacles", ink: "obstacles" },
    { part: "spots", text: "laser spots", ink: "spots" },
    { part: "beams", text: "beams and ways of the light", ink: "spots" },
    { part: "camera", text: "camera and its view", ink: "camera" },
];

/**
 * The bench in words.
 * @param {BenchBlock} block
 */
function inWords({ name, unit, surfaces, spots, laser, camera }) {
    const of = (/** @type {SurfaceBlock["role"]} */ role) => surfaces.filter((s) => s.role === role).map((s) => s.name);
    const list = (/** @type {string} */ what, /** @type {string[]} */ names) => (names.length === 0 ? "" : `${what}: ${names.slice(0, 12).join(", ")}${names.length > 12 ? " and others" : ""}. `);
    return (
        `Scene ${name}, drawn to scale. ${list("Walls", of("relay"))}${list("Hidden", of("hidden"))}${list("Obstacles", of("occluder"))}` +
        `${laser === null ? "The hidden surface shines." : `${spots.count} laser spots. Laser at ${pointWords(laser, unit)}.`} Camera at ${pointWords(camera.position, unit)}, ${camera.columns} by ${camera.rows} pixels.`
    );
}

/**
 * Steps of the sight, by key and by button.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function stepsOf(bench, sight) {
    const { controls } = sight;
    const turn = (/** @type {number} */ left, /** @type {number} */ up) => () => {
        sight.view = "3-D";
        controls.rotateLeft(left * STEP.turn);
        controls.rotateUp(up * STEP.turn);
        sight.turned();
    };
    const move = (/** @type {number} */ x, /** @type {number} */ y) => () => controls.pan(x * STEP.move, y * STEP.move);
    const zoom = (/** @type {number} */ by) => () => zoomBy(sight, by);
    return {
        left: turn(1, 0),
        right: turn(-1, 0),
        up: turn(0, 1),
        down: turn(0, -1),
        closer: zoom(STEP.zoom),
        farther: zoom(1 / STEP.zoom),
        moveLeft: move(1, 0),
        moveRight: move(-1, 0),
        moveUp: move(0, 1),
        moveDown: move(0, -1),
        again: () => showView(bench, sight, sight.view),
    };
}

/**
 * Keys, and the wheel while the drawing has the focus: else the page scrolls.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function steer(bench, sight) {
    const { canvas, controls } = sight;
    const steps = stepsOf(bench, sight);
    /** @type {Record<string, () => void>} */
    const keys = {
        ArrowLeft: steps.left,
        ArrowRight: steps.right,
        ArrowUp: steps.up,
        ArrowDown: steps.down,
        "+": steps.closer,
        "=": steps.closer,
        "-": steps.farther,
        Home: steps.again,
    };
    const shifted = /** @type {Record<string, () => void>} */ ({ ArrowLeft: steps.moveLeft, ArrowRight: steps.moveRight, ArrowUp: steps.moveUp, ArrowDown: steps.moveDown });
    canvas.addEventListener("keydown", (event) => {
        const step = event.ctrlKey || event.metaKey || event.altKey ? undefined : ((event.shiftKey && shifted[event.key]) || keys[event.key]);
        if (step !== undefined) {
            event.preventDefault();
            step();
        }
    });
    const wheel = (/** @type {WheelEvent} */ event) => {
        if (document.activeElement !== canvas && !event.ctrlKey) {
            event.stopImmediatePropagation();
        }
    };
    canvas.addEventListener("wheel", wheel, { capture: true });
    // A drag that turns leaves the view along an axis.
    let before = sight.camera.quaternion.clone();
    controls.addEventListener("start", () => (before = sight.camera.quaternion.clone()));
    controls.addEventListener("end", () => {
        if (before.angleTo(sight.camera.quaternion) > 1e-3) {
            sight.view = "3-D";
            sight.turned();
        }
    });
}

/**
 * Buttons for the views, for turning and for zooming.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function viewButtons(bench, sight) {
    const steps = stepsOf(bench, sight);
    const button = (/** @type {string} */ text, /** @type {string} */ label, /** @type {() => void} */ click) => make("button", { type: "button", "aria-label": label, title: label, click }, text);
    const names = /** @type {ViewName[]} */ (["3-D", "Top", "Side", "Front"]);
    const views = names.map((name) => {
        const text = name === "3-D" ? name : `${name} (${planeOf(bench, name)})`;
        return make("button", { type: "button", "data-view": name, click: () => showView(bench, sight, name) }, text);
    });
    const whole = make("button", { type: "button", click: () => {
        sight.whole = !sight.whole;
        fitView(bench, sight);
        sight.turned();
    } }, "with laser and camera");
    sight.turned = () => {
        views.forEach((view) => view.setAttribute("aria-pressed", String(view.dataset.view === sight.view)));
        whole.setAttribute("aria-pressed", String(sight.whole));
    };
    return make(
        "div",
        { class: "bench-buttons" },
        make("span", { role: "group", "aria-label": "View" }, ...views, whole),
        make(
            "span",
            { role: "group", "aria-label": "Turn and zoom" },
            button("←", "turn left", steps.left),
            button("→", "turn right", steps.right),
            button("↑", "turn up", steps.up),
            button("↓", "turn down", steps.down),
            button("+", "closer", steps.closer),
            button("−", "farther", steps.farther),
        ),
    );
}

/**
 * The legend, whose entries show and hide.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function partBoxes(bench, sight) {
    const present = PARTS.filter(({ part }) => bench.parts[part].children.length > 0);
    const boxes = present.map(({ part, text, ink }) => {
        const change = (/** @type {{ target: HTMLInputElement }} */ { target }) => {
            bench.parts[part].visible = target.checked;
            sight.draw();
        };
        const box = make("input", { type: "checkbox", checked: true, name: `bench-${part}`, change });
        const swatch = make("span", { class: "bench-swatch", style: `background: var(${INKS[ink]})` });
        return make("label", { class: "tick" }, box, swatch, text);
    });
    return make("fieldset", { class: "controls bench-parts" }, make("legend", {}, "Shown"), ...boxes);
}
