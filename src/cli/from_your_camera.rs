//! From your camera to a picture, command by command.
#![doc = include_str!("from_your_camera.md")]
