// The bench in three dimensions: what the reader turns, zooms and chooses with. Without WebGL the static drawing below it is the drawing.

upgrade("#bench-3d", async (element) => {
    const block = /** @type {BenchBlock | undefined} */ (data("bench"));
    if (block === undefined) {
        return;
    }
    const canvas = make("canvas", { tabindex: 0, role: "application", "aria-roledescription": "drawing", "aria-label": inWords(block), "aria-describedby": "bench-keys" });
    const renderer = rendererOn(canvas);
    if (renderer === undefined) {
        element.append(make("p", { class: "note" }, "This browser shows no WebGL, so the bench does not turn here: its side and top views follow."));
        return;
    }
    // From here on all of the script has run, constants of other files included.
    const [vertices, triangles, coordinates, spots] = await Promise.all(["vertices", "triangles", "coordinates", "spots"].map((id) => numbers(`bench-${id}`)));
    const bench = buildBench(block, { vertices: vertices ?? [], triangles: triangles ?? [], coordinates: coordinates ?? [], spots: spots ?? [] });
    const layer = make("div", { class: "bench-names", "aria-hidden": "true" });
    const bar = make("div", { class: "bench-scale", "aria-hidden": "true" }, make("i"), make("span"));
    const stage = make("div", { class: "bench-stage" }, canvas, layer, bar);
    const said = make("p", { class: "bench-choice" });
    element.classList.add("bench-live");
    const sight = lookAtBench(bench, stage, canvas, renderer);
    element.append(viewButtons(bench, sight), stage, said, partBoxes(bench, sight), make("p", { class: "note", id: "bench-keys" }, STEERING_KEYS));
    const follows = followChoice(bench);
    const { lines, labels } = axesOf(bench);
    bench.root.add(lines);
    const names = [...labelsOf(bench), ...labels];
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const ink = () => {
        inkAgain(bench);
        renderer.setClearColor(bench.inks.ground);
        sight.draw();
    };
    dark.addEventListener("change", ink);
    ink();
    sight.drawn.push(
        () => placeLabels(bench, sight, layer, names),
        () => placeScale(bench, sight, bar),
        () => {
            canvas.dataset.projection = JSON.stringify(projectionOf(bench, sight));
            canvas.dataset.view = sight.view;
        },
    );
    const chose = () => {
        said.textContent = follows(chosen);
        sight.draw();
    };
    onChoice(chose);
    chose();
    chooseByPointer(bench, sight);
    steer(bench, sight);
    let untouched = true;
    sight.controls.addEventListener("start", () => (untouched = false));
    new ResizeObserver(() => {
        measureStage(sight);
        if (untouched) {
            fitView(bench, sight);
        }
    }).observe(stage);
    measureStage(sight);
    showView(bench, sight, "3-D");
});
