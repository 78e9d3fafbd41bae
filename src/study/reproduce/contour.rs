//! Fig 21: how G12 lies over the wall.

use super::inversion::published;
use super::{Gallery, Picture, Shades};
use crate::model::{Kernel, Stagger};

/// Elements a side.
const SIDE: usize = 8;

/// Fig 21: G12 of two corner elements over the wall around C.
pub(super) fn contours() -> Gallery {
    let (side, reach) = (61, 7.5);
    let mut pictures = Vec::new();
    for (kernel, name) in [
        (Kernel::Published, "published"),
        (Kernel::Physical, "physical"),
    ] {
        for [i, j] in [[0, 0], [7, 7]] {
            let case = published(kernel, SIDE, 2, reach, Stagger::None);
            let values = case.g12_over(i + SIDE * j, reach, side);
            let title = format!("{name} kernel, element ({}, {})", i + 1, j + 1);
            pictures.push(Picture {
                title,
                size: [side; 2],
                values,
                axes: ["x", "y"].map(str::to_owned),
                width: 2.0 * reach,
            });
        }
    }
    Gallery {
        title: "G12 of two corner elements over the wall, 7.5 in. either side of C".to_owned(),
        shades: Shades::Values,
        unit: "G12 / in.⁻²".to_owned(),
        pictures,
    }
}
