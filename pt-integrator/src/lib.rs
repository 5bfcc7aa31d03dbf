//! Path tracing that records its vertices: camera, samplers, BSDFs, lights.
