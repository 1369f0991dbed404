//! Rewrites the tables of the plugin's pages in place: what it does and costs, compared with what a game can do without it.
//!
//! `just plugin-report PAGE` runs it; `--help` lists the options.

mod avian;
mod characters;
mod continuous;
mod crowds;
mod model;
mod physics;
mod tolerance;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use morph_collision_testkit::report::{Section, SectionOptions, Store, origin, rewrite};
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::physics::Method;
use physics::Comparison;

/// Measures the tables of one of the plugin's pages.
#[derive(Parser)]
struct Options {
    /// The page.
    page: Page,
    /// The folder of the pages.
    #[arg(long, default_value = "docs")]
    docs: PathBuf,
    /// Instead, run a few frames of this crowd, for tools that count instructions.
    #[arg(long)]
    count: Option<crowds::Way>,
    /// The same for a crowd around whose queries a frame is counted.
    #[arg(long)]
    count_run: Option<crowds::Crowd>,
    /// What there is besides Bevy in that crowd.
    #[arg(long, default_value = "collisions")]
    with: crowds::With,
    #[command(flatten)]
    sections: SectionOptions,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Page {
    /// Avian's bodies on morphing surfaces.
    Avian,
    /// Crowds of skinned characters, with Bevy's own bounds and picking, and with capsules in Rapier.
    Characters,
    /// The longest updates with continuous bodies that collapse, blow up or slide over each other.
    Continuous,
    /// Crowds in which nothing happens to most characters.
    Crowds,
    /// Rapier's bodies on morphing surfaces.
    Rapier,
    /// Time against error for colliders with a tolerance.
    Tolerance,
}

const RAPIER: Comparison<Method> = Comparison {
    methods: &Method::ALL,
    shot_at: &[Method::Ours, Method::NewMesh, Method::SoftBody, Method::Kinematic],
    dropped: &[Method::Ours, Method::NewMesh],
    ccd: &[Some(false), Some(true)],
    speeds: &[1.0, 2.0, 5.0, 20.0],
};

const AVIAN: Comparison<avian::Method> = Comparison {
    methods: &[avian::Method::Ours, avian::Method::NewMesh],
    shot_at: &[avian::Method::Ours, avian::Method::NewMesh, avian::Method::Kinematic],
    dropped: &[avian::Method::Ours, avian::Method::NewMesh],
    ccd: &[None],
    speeds: &[1.0],
};

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), String> {
    if let Some(way) = options.count {
        return crowds::count(way);
    }
    if let Some(crowd) = options.count_run {
        return crowds::count_run(crowd, options.with);
    }
    let quick = options.sections.quick;
    let store = Store::below(&options.docs);
    let mut sections: Vec<Section<'_>> = match options.page {
        Page::Avian => AVIAN.sections(quick),
        Page::Characters => characters::sections(quick),
        Page::Continuous => vec![("worst-updates", Box::new(move || continuous::table(quick)))],
        Page::Crowds => crowds::sections(quick),
        Page::Rapier => RAPIER.sections(quick),
        Page::Tolerance => vec![("time-and-error", Box::new(move || tolerance::table(quick, &store)))],
    };
    if options.page != Page::Avian {
        let machine = || {
            let origin = origin(&options.docs).map_err(|error| error.to_string())?;
            Ok(format!("{origin}.\n"))
        };
        sections.insert(0, ("machine", Box::new(machine)));
    }
    let name = options.page.to_possible_value().unwrap_or_default();
    let path = options.docs.join(name.get_name()).with_extension("md");
    rewrite(&path, &options.sections, &sections)
}
