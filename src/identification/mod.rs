//! From records and tables to models: regressors, fits, reports.
