//! Reading and writing glTF: what is read, what is refused, and that reader and writer agree.

mod bombs;
mod broken;
mod compressed;
mod exporters;
mod expressions;
mod matrix;
mod reading;
mod reference;
mod scenes;
mod skins;
mod skip_bad;
mod support;
mod unused;
mod uris;
mod writing;
mod writing_skins;
