//! Names come from anyone: what a terminal or a browser would obey in them is spelled out.

/// Whether `c` is obeyed in place of shown: control characters (escape sequences begin with one),
/// and the marks that turn the direction of the text behind them (Unicode, UAX 9), so that
/// `exe.png` can be shown for what ends in `gnp.exe`.
fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// `text` for a terminal, a table or a page: line feeds and tabs stay, other characters that would
/// be obeyed are spelled out.
pub fn harmless(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => out.push(c),
            c if is_obeyed(c) => out.extend(c.escape_unicode()),
            c => out.push(c),
        }
    }
    out
}

/// A word of a command line as a shell takes it: in quotes where it has to be.
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-+=./:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The same JSON without any such character, in which they can stand in strings only (but line
/// feeds and tabs, which JSON may have between values).
pub fn harmless_json(json: &str) -> String {
    spelled(json, |c| format!("\\u{:04x}", u32::from(c)))
}

/// JSON for a page, where a string is shown: what would be obeyed there is shown spelled out.
pub fn shown_json(json: &str) -> String {
    spelled(json, |c| format!("\\\\u{{{:x}}}", u32::from(c)))
}

fn spelled(json: &str, spell: impl Fn(char) -> String) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '\n' | '\t' => out.push(c),
            c if is_obeyed(c) => out += &spell(c),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every character that UAX 9 lists as an explicit directional mark, and a title of a terminal.
    const WILD: &str = "\u{1b}]0;x\u{7}\u{9b}31m\u{7f}\u{61c}\u{200e}\u{200f}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}";

    #[test]
    fn what_would_be_obeyed_is_spelled_out() {
        let shown = harmless(WILD);
        assert!(
            shown.is_ascii() && !shown.contains(char::is_control),
            "{shown}"
        );
        assert!(shown.starts_with(r"\u{1b}]0;x\u{7}\u{9b}31m"), "{shown}");
        let plain = "Φcam, 3 × 2\n\tשלום ü";
        assert_eq!(harmless(plain), plain);
    }

    #[test]
    fn json_stays_the_same_json() {
        let json = serde_json::to_string(WILD).unwrap();
        let safe = harmless_json(&json);
        assert!(safe.is_ascii(), "{safe}");
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), WILD);
        let shown: String = serde_json::from_str(&shown_json("\"a\u{202e}b\"")).unwrap();
        assert_eq!(shown, harmless("a\u{202e}b"));
    }
}
