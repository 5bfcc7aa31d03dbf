//! glTF files, images and environment maps as scene data for hashcache.
