// Tables that are wider than their box say that they scroll.

upgrade(".wide", (box) => {
    const words = make("p", { class: "note scrolls", hidden: true }, "→ This table is wider than the screen: it scrolls sideways.");
    box.before(words);
    const tell = () => {
        words.hidden = box.scrollWidth <= box.clientWidth + 1;
    };
    new ResizeObserver(tell).observe(box);
    tell();
});
