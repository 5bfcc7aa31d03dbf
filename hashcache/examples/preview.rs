//! A picture of a scene, from a program of one's own:
//! `cargo run --release -p hashcache --example preview -- builtin:cornell cornell.png KEY=VALUE…`

use std::path::Path;

use hashcache::{Preview, Settings, image_file};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "builtin:cornell".to_owned());
    let picture = arguments.next().unwrap_or_else(|| "preview.png".to_owned());
    let mut settings = Settings::default();
    for setting in arguments {
        let (key, value) = setting.split_once('=').ok_or("settings are written KEY=VALUE")?;
        settings.set(key, value)?;
    }

    let preview = Preview::open(&scene, &settings)?;
    print!("{}", preview.plan());
    let rendered = preview.render(&mut |_| ())?;
    image_file::write(Path::new(&picture), &rendered.image)?;
    println!("{}", serde_json::to_string_pretty(&rendered.stats)?);
    Ok(())
}
