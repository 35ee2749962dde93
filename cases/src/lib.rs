//! Cases of Meniscus: scenes as data, the particles that fill them, the pipeline that they choose, and
//! the exact solutions that they are measured against.

pub mod assemble;
pub mod measure;
pub mod packing;
pub mod region;
pub mod scene;
pub mod shape;
pub mod simulation;
