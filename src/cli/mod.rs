//! The program: one file for each verb.
