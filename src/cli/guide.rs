//! The guide: everything between the README and the reference of the modules.
//!
//! | chapter | what is in it |
//! | --- | --- |
//! | [`tutorial`] | the main job, a wrong model, a doubtful picture, a camera, noise: commands with what they print |
//! | [`gallery`] | the pictures, each with the command that makes it |
//! | [`scenes`] | what a scene can hold, and a scene of one's own |
//! | [`photographs`] | photographs of a real camera |
//! | [`commands`] | every command in a line |
//! | [`estimators`] | three ways to trace one matrix |
//! | [`files`] | what a run leaves, and how NumPy, xarray, Octave and MATLAB read it |
//! | [`sensor`] | from flux to what a camera counts |
//! | [`many_machines`] | shards, resuming, and what is never overwritten |
//! | [`methods_compared`] | phicam beside Mitsuba 3, mitransient and a NumPy script |
//! | [`source_map`] | which folder of the sources has what |
//! | [`contributing`] | the fast tests; how to add a material, an estimator, a study, a method |
//!
//! The published method is that of S. S. Ferrel, *Matrix determination of reflectance of hidden
//! object by indirect photography*, M.S. thesis, Air Force Institute of Technology; before it M.
//! Hoelscher, *Restoration of scene information reflected from non-specular media*, dissertation,
//! 2011.

pub mod commands {
    #![doc = include_str!("guide/commands.md")]
}

pub mod contributing {
    #![doc = include_str!("guide/contributing.md")]
}

pub mod estimators {
    #![doc = include_str!("guide/estimators.md")]
}

pub mod files {
    #![doc = include_str!("guide/files.md")]
}

pub mod gallery {
    #![doc = include_str!("guide/gallery.md")]
}

pub mod many_machines {
    #![doc = include_str!("guide/many_machines.md")]
}

pub mod methods_compared {
    #![doc = include_str!("guide/methods_compared.md")]
}

pub mod photographs {
    #![doc = include_str!("guide/photographs.md")]
}

pub mod scenes {
    #![doc = include_str!("guide/scenes.md")]
}

pub mod sensor {
    #![doc = include_str!("guide/sensor.md")]
}

pub mod source_map {
    #![doc = include_str!("guide/source_map.md")]
}

pub mod tutorial {
    #![doc = include_str!("guide/tutorial.md")]
}
