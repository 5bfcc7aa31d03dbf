//! The command, run as users run it.

mod bad_command_lines;
mod bad_files;
mod bad_input;
mod bad_moves;
mod bad_scenes;
mod command;
mod fly;
mod pictures;
mod place;
mod scene;
mod table;
mod trade;
