"""`python -m somo_cli` is `somo`, for where the command itself is not on the path."""

from somo_cli.cli import main

if __name__ == "__main__":
    main()
