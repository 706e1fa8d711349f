"""Result files to pictures."""
