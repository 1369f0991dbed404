//! Two peers play over a network with latency. Each predicts what the other player does, and goes back when it was wrong.
//!
//! The players are soft bodies that bump into each other. Everything that a rollback library such as `bevy_ggrs` does is in `Peer`, in small;
//! what it needs from the plugin is `MorphCollisionState`. At the end, both peers have the same checksum. docs/netcode.md explains it.

use std::collections::VecDeque;
use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::transform::systems::mark_dirty_trees;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_models::generated::random::random_blob;
use morph_collision_workspace::app;
use morph_collision_workspace::outcome::print_report;
use morph_collision_workspace::physics::bevy_mesh;
use serde::Serialize;

/// Two peers with latency, prediction and rollback.
#[derive(Parser)]
struct Options {
    /// How many frames they play.
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Print only the result, as one JSON object.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let report = play_together(options.frames);
    print_report(&report, options.json);
    ExitCode::from(u8::from(!report.is_in_sync))
}

/// A frame of the game. It depends only on what [`Saved`] has, and on the inputs.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Tick;

/// Where both players go in this frame: -1, 0 or 1.
#[derive(Resource, Clone, Copy, Default)]
struct Inputs([i8; 2]);

#[derive(Component, Clone, Copy)]
struct Player {
    number: usize,
    /// How long the player has breathed, in frames.
    breath: u32,
    hits: u32,
}

fn game(app: &mut App) {
    app.add_plugins(MorphCollisionPlugin.in_schedule(Tick))
        .init_resource::<Inputs>()
        .add_systems(Startup, spawn)
        .add_systems(
            Tick,
            (walk.before(mark_dirty_trees), bump.after(MorphCollisionSystems::Events)),
        );
}

/// Both peers spawn in the same order, so that the order of entities is the same, and with it that of contacts.
fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    let mesh = meshes.add(bevy_mesh(&random_blob(7, 2, 2, 0.4)));
    // Nobody passes through the other, however far a frame takes them.
    let collider = MorphCollider::new(MorphCollisionMode::Contacts).with_continuous(true);
    for number in 0..2 {
        let place = Transform::from_xyz(3.0 * number as f32, 0.0, 0.0);
        let (breath, hits) = (0, 0);
        let player = Player { number, breath, hits };
        let weights = MeshMorphWeights::Value { weights: vec![0.0; 2] };
        commands.spawn((Mesh3d(mesh.clone()), place, collider, weights, player));
    }
}

/// Players walk, and breathe.
fn walk(inputs: Res<Inputs>, mut players: Query<(&mut Transform, &mut MeshMorphWeights, &mut Player)>) {
    for (mut place, mut weights, mut player) in &mut players {
        player.breath += 1;
        place.translation.x += 0.07 * f32::from(inputs.0[player.number]);
        place.translation.x = place.translation.x.clamp(-3.0, 6.0);
        // Up and down. A sine has other bits on other machines.
        let phase = (player.breath + 20 * player.number as u32) % 60;
        let chest = 0.02 * phase.abs_diff(30) as f32;
        *weights = MeshMorphWeights::Value {
            weights: vec![chest, 0.5 - chest],
        };
    }
}

/// Players that touch push each other away. `started` says what this frame began, also when it is simulated again; messages would tell it twice.
fn bump(collisions: Res<MorphCollisions>, mut players: Query<(&mut Transform, &mut Player)>) {
    for contact in collisions.started() {
        for (entity, way) in [
            (contact.collider1, contact.normal),
            (contact.collider2, -contact.normal),
        ] {
            if let Ok((mut place, mut player)) = players.get_mut(entity) {
                player.hits += 1;
                place.translation.x += 0.15 * way.x;
            }
        }
    }
}

/// What a peer needs to go back: the game's own components, and what the plugin remembers.
struct Saved {
    players: Vec<(Entity, Transform, MeshMorphWeights, Player)>,
    collisions: MorphCollisionState,
}

/// How many frames a peer can go back. No input takes longer.
const MOST: usize = 12;

struct Peer {
    app: App,
    number: usize,
    /// The inputs of both players that have arrived.
    known: [Vec<i8>; 2],
    /// The inputs with which frames were simulated.
    used: Vec<[i8; 2]>,
    /// The states before the last frames.
    saved: VecDeque<Saved>,
    rollbacks: u32,
    simulated: u32,
}

impl Peer {
    fn new(number: usize) -> Self {
        let mut app = app::without_collisions(Path::new("assets"));
        app.add_plugins(game);
        app::ready(&mut app);
        // Before they begin, everything is loaded.
        app.update();
        while app.world().resource::<MorphTrees>().building() > 0 {
            app.update();
        }
        Self {
            app,
            number,
            known: [Vec::new(), Vec::new()],
            used: Vec::new(),
            saved: VecDeque::new(),
            rollbacks: 0,
            simulated: 0,
        }
    }

    /// Simulates a frame. The other player is assumed to go on as before.
    fn advance(&mut self) {
        let frame = self.used.len();
        let inputs = [0, 1].map(|player| {
            let known: &Vec<i8> = &self.known[player];
            *known.get(frame).or(known.last()).unwrap_or(&0)
        });
        let world = self.app.world_mut();
        MorphCollisionState::save(world);
        let mut players = world.query::<(Entity, &Transform, &MeshMorphWeights, &Player)>();
        let players = players.iter(world);
        let players = players.map(|(entity, place, weights, player)| (entity, *place, weights.clone(), *player));
        self.saved.push_back(Saved {
            players: players.collect(),
            collisions: world.resource::<MorphCollisionState>().clone(),
        });
        if self.saved.len() > MOST {
            self.saved.pop_front();
        }
        world.insert_resource(Inputs(inputs));
        world.run_schedule(Tick);
        self.used.push(inputs);
        self.simulated += 1;
    }

    /// Takes inputs of the other player. If one of them was predicted wrongly, goes back and simulates again.
    fn receive(&mut self, inputs: &[i8]) {
        let (other, now) = (1 - self.number, self.used.len());
        let first = self.known[other].len();
        self.known[other].extend(inputs);
        let mut news = self.known[other].iter().enumerate().skip(first);
        let is_wrong = |&(frame, input): &(usize, &i8)| self.used.get(frame).is_some_and(|used| used[other] != *input);
        let Some((wrong, _)) = news.find(is_wrong) else { return };
        let first_saved = now - self.saved.len();
        self.saved.truncate((wrong + 1).saturating_sub(first_saved));
        // Inputs that are older than every state do not exist here. A game would end the session.
        let Some(saved) = self.saved.pop_back() else { return };
        let world = self.app.world_mut();
        for (entity, place, weights, player) in saved.players {
            world.entity_mut(entity).insert((place, weights, player));
        }
        world.insert_resource(saved.collisions);
        MorphCollisionState::restore(world);
        self.used.truncate(wrong);
        self.rollbacks += 1;
        while self.used.len() < now {
            self.advance();
        }
    }

    /// Bits of everything that the game and the plugin know.
    fn checksum(&mut self) -> u64 {
        let mut bits: Vec<u32> = Vec::new();
        let world = self.app.world_mut();
        for (place, player) in world.query::<(&Transform, &Player)>().iter(world) {
            bits.extend(place.translation.to_array().map(f32::to_bits));
            bits.push(player.hits);
        }
        for contact in world.resource::<MorphCollisions>().iter() {
            let vectors = [contact.point, contact.normal];
            bits.extend(vectors.iter().flat_map(|vector| vector.to_array().map(f32::to_bits)));
            bits.extend(
                contact
                    .triangles
                    .iter()
                    .map(|pair| pair.triangle_a ^ pair.triangle_b << 16),
            );
        }
        bits.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, bits| {
            (hash ^ u64::from(bits)).wrapping_mul(0x0100_0000_01b3)
        })
    }

    fn hits(&mut self) -> u32 {
        let world = self.app.world_mut();
        world.query::<&Player>().iter(world).map(|player| player.hits).sum()
    }
}

/// What a player does in a frame: the same for some frames, then something else.
fn input(player: usize, frame: usize) -> i8 {
    (noise(player, frame / 9) % 3) as i8 - 1
}

/// In which frame the other peer gets an input: three to nine frames later, and never before an earlier one.
fn arrival(player: usize, frame: usize) -> usize {
    let sent = frame.saturating_sub(6)..=frame;
    let all = sent.map(|frame| frame + 3 + noise(player + 2, frame) % 7);
    all.max().unwrap_or(frame)
}

fn noise(a: usize, b: usize) -> usize {
    let mixed = (a as u32 + 1).wrapping_mul(2_654_435_761) ^ (b as u32 + 1).wrapping_mul(2_246_822_519);
    ((mixed ^ mixed >> 15).wrapping_mul(974_634_641) >> 12) as usize
}

/// What became of a session.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) frames: u32,
    pub(crate) rollbacks: [u32; 2],
    pub(crate) simulated: [u32; 2],
    pub(crate) hits: [u32; 2],
    pub(crate) checksums: [String; 2],
    pub(crate) is_in_sync: bool,
}

/// Two peers play so many frames.
#[must_use]
pub(crate) fn play_together(frames: u32) -> Report {
    let mut peers = [0, 1].map(Peer::new);
    // The last inputs arrive after the last frame.
    for now in 0..frames as usize + MOST {
        for peer in &mut peers {
            let other = 1 - peer.number;
            let is_there = |&frame: &usize| frame < frames as usize && arrival(other, frame) <= now;
            let arrived: Vec<i8> = (peer.known[other].len()..)
                .take_while(is_there)
                .map(|frame| input(other, frame))
                .collect();
            peer.receive(&arrived);
            if now < frames as usize {
                peer.known[peer.number].push(input(peer.number, now));
                peer.advance();
            }
        }
    }
    let checksums = peers.each_mut().map(Peer::checksum);
    Report {
        frames,
        rollbacks: peers.each_ref().map(|peer| peer.rollbacks),
        simulated: peers.each_ref().map(|peer| peer.simulated),
        hits: peers.each_mut().map(Peer::hits),
        is_in_sync: checksums[0] == checksums[1],
        checksums: checksums.map(|checksum| format!("{checksum:016x}")),
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for peer in 0..2 {
            writeln!(
                f,
                "peer {}: {} frames, {} rollbacks, {} frames simulated again, {} hits, checksum {}",
                peer + 1,
                self.frames,
                self.rollbacks[peer],
                self.simulated[peer] - self.frames,
                self.hits[peer],
                self.checksums[peer],
            )?;
        }
        let sync = if self.is_in_sync { "are equal" } else { "differ" };
        write!(f, "the checksums {sync}")
    }
}
