//! Pictures in the languages of terminals.

use super::colour::Rgb;
use super::encode::base64;

/// Bytes of a message of the kitty protocol.
const MESSAGE: usize = 4096;

/// A line of characters, each of an upper and a lower colour; without a lower one the terminal's
/// own ground.
pub(super) fn half_blocks(cells: impl Iterator<Item = (Option<Rgb>, Option<Rgb>)>) -> String {
    let mut line = String::new();
    for (upper, lower) in cells {
        let code = |kind: u8, colour: Option<Rgb>| match colour {
            Some([r, g, b]) => format!("\x1b[{kind}8;2;{r};{g};{b}m"),
            None => format!("\x1b[{kind}9m"),
        };
        line += &code(3, upper);
        line += &code(4, lower);
        line.push('▀');
    }
    line + "\x1b[0m"
}

/// A PNG as the kitty graphics protocol sends it, `columns` cells wide: in messages of 4096 bytes
/// of base64, all but the last marked m=1.
pub fn kitty(png: &[u8], columns: usize) -> String {
    let data = base64(png);
    let pieces = data.len().div_ceil(MESSAGE);
    let mut text = String::new();
    for k in 0..pieces {
        let piece = &data[k * MESSAGE..((k + 1) * MESSAGE).min(data.len())];
        let more = u8::from(k + 1 < pieces);
        let first = match k {
            0 => format!("a=T,f=100,c={columns},"),
            _ => String::new(),
        };
        text += &format!("\x1b_G{first}m={more};{piece}\x1b\\");
    }
    text + "\n"
}

/// A PNG as an inline image of iTerm2, `columns` cells wide.
pub fn iterm(png: &[u8], columns: usize) -> String {
    let size = png.len();
    let data = base64(png);
    format!(
        "\x1b]1337;File=inline=1;size={size};width={columns};preserveAspectRatio=1:{data}\x07\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_block_is_the_upper_colour_over_the_lower() {
        let [a, b] = [[1, 2, 3], [40, 50, 60]];
        assert_eq!(
            half_blocks([(Some(a), Some(b)), (Some(b), None)].into_iter()),
            "\x1b[38;2;1;2;3m\x1b[48;2;40;50;60m▀\x1b[38;2;40;50;60m\x1b[49m▀\x1b[0m"
        );
    }

    #[test]
    fn protocols_carry_the_whole_picture() {
        let png: Vec<u8> = (0..10_000_u32).map(|k| (k * k) as u8).collect();
        let text = kitty(&png, 60);
        let pieces: Vec<&str> = text
            .trim_end()
            .split("\x1b\\")
            .filter(|p| !p.is_empty())
            .collect();
        assert!(pieces[0].starts_with("\x1b_Ga=T,f=100,c=60,m=1;"));
        let last = pieces.len() - 1;
        assert!(pieces[last].starts_with("\x1b_Gm=0;"));
        let data: String = pieces
            .iter()
            .map(|p| p.split_once(';').unwrap().1)
            .collect();
        assert_eq!(data, base64(&png));
        assert!(
            pieces
                .iter()
                .all(|p| p.split_once(';').unwrap().1.len() <= 4096)
        );
        let text = iterm(&png, 60);
        assert!(text.contains("size=10000;") && text.ends_with(&format!(":{data}\x07\n")));
    }
}
