//! Global-illumination caching for interactive previews: plan, pipeline, statistics.
