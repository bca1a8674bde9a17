//! Materials against differences, closed forms and what must hold for any law.

mod bounds;
mod derivatives;
mod invariance;
mod states;
