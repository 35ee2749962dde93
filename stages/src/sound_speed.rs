//! The speed of sound of every particle: a column only where it differs from one to the other.

use crate::fields;
use meniscus_engine::group::Chunk;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::store::Read;
use meniscus_engine::wiring::Wiring;
use std::cell::Ref;
use std::ops::Range;

/// Where a stage finds it.
#[derive(Clone, Copy, Debug)]
pub enum SoundSpeed {
    /// It is the same everywhere, m/s.
    Constant(f64),
    /// The equation of state writes it.
    Column(Read<f64>),
}

impl SoundSpeed {
    /// For a liquid whose speed of sound is constant (m/s), or not.
    pub fn new(wiring: &mut Wiring, constant: Option<f64>) -> Self {
        match constant {
            Some(speed) => SoundSpeed::Constant(speed),
            None => SoundSpeed::Column(wiring.read(&fields::SOUND_SPEED)),
        }
    }

    /// Those of a chunk.
    pub fn of<'a>(self, chunk: &'a Chunk) -> SoundSpeeds<'a> {
        match self {
            SoundSpeed::Constant(speed) => SoundSpeeds::Constant(speed),
            SoundSpeed::Column(column) => SoundSpeeds::Column(chunk.read(column)),
        }
    }
}

/// The speeds of sound of a chunk of particles.
#[derive(Debug)]
pub enum SoundSpeeds<'a> {
    /// The same for all, m/s.
    Constant(f64),
    /// One for each, m/s.
    Column(Ref<'a, [f64]>),
}

impl SoundSpeeds<'_> {
    /// That of one particle, m/s.
    #[inline(always)]
    pub fn at(&self, i: usize) -> f64 {
        match self {
            SoundSpeeds::Constant(speed) => *speed,
            SoundSpeeds::Column(column) => column[i],
        }
    }

    /// Those of up to eight particles, m/s.
    #[inline(always)]
    pub fn of(&self, eight: Range<usize>) -> Lanes {
        match self {
            SoundSpeeds::Constant(speed) => Lanes::splat(*speed),
            SoundSpeeds::Column(column) => Lanes::load_or(&column[eight], 0.0),
        }
    }
}
