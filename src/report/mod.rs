//! Floor `report`.
