//! A jittered spatial hash of light path vertices (path space filtering).
