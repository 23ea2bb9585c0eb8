"""Random extreme contact scenes: what is unphysical must not end as if all were well."""
