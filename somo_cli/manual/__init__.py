"""The manual: Markdown pages, which `somo help` shows and which read well on the web too."""
