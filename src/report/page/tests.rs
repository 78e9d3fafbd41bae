use super::super::svg::well_formed;
use super::*;

fn page() -> Page {
    let mut page = Page::new("A <title> & more");
    page.verdict(Tone::Good, "Traced & modelled agree: χ²/dof 1.0.");
    page.section("one", "First <section>", "<p>text</p>\n");
    page.section("none", "Empty", "");
    page
}

#[test]
fn a_page_is_well_formed_and_lists_its_sections() {
    let html = page().html();
    well_formed(&html).unwrap();
    assert!(html.contains("<title>A &lt;title&gt; &amp; more</title>"));
    assert!(html.contains("<a href=\"#one\">First &lt;section&gt;</a>"));
    assert!(html.contains("<section id=\"one\">") && !html.contains("id=\"none\""));
}

/// Whatever stands in the data, its element ends where it ends.
#[test]
fn data_cannot_leave_their_element() {
    let mut page = page();
    page.json("odd", &["</script><script>alert(1)</script>", "<!--"]);
    let html = page.html();
    let block = html.split("id=\"odd\">").nth(1).unwrap();
    let text = block.split("</script>").next().unwrap();
    let back: Vec<String> = serde_json::from_str(text).unwrap();
    assert_eq!(back, ["</script><script>alert(1)</script>", "<!--"]);
}

#[test]
fn libraries_are_there_once_where_they_are_used_with_their_licences() {
    assert!(!page().html().contains("Libraries in this page"));
    let mut page = page();
    page.needs(Library::Plot);
    page.needs(Library::Three);
    page.needs(Library::Plot);
    let html = page.html();
    assert_eq!(html.matches("var Plot=").count(), 1);
    assert_eq!(html.matches("var THREE=").count(), 1);
    assert!(
        html.contains("Permission is hereby granted") && html.contains("Libraries in this page")
    );
    // The element of a script ends at the first such tag: none may stand inside of a library.
    for library in [Library::Plot, Library::Three] {
        assert!(!library.text().to_lowercase().contains("</script"));
    }
}

/// Lines of comments go, whatever else is on a line stays.
#[test]
fn scripts_lose_their_comments_alone() {
    let script = "// A file.\n\n/** One line. */\nconst a = 1; // stays\n/**\n * Many.\n * @param {x} y\n */\n    \
                  /** @type {any} */ (b).c = \"/** stays\";\n    // gone\nconst d = `//`;\n";
    let left =
        "\nconst a = 1; // stays\n    /** @type {any} */ (b).c = \"/** stays\";\nconst d = `//`;\n";
    assert_eq!(without_comments(script), left);
    for script in SCRIPT {
        assert!(without_comments(script).len() < script.len());
        // No template spans lines, so no line of one is taken for a comment.
        assert!(
            script
                .lines()
                .all(|line| line.matches('`').count() % 2 == 0)
        );
    }
}
