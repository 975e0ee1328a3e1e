//! Every integration test, one file a stage, named as in `src`.

<<<<<<< HEAD
mod cli;
mod crack;
=======
mod data;
>>>>>>> bench
mod facts;
mod gltf;
mod oracle;
mod read;
mod support;
mod verify;
mod volume;
