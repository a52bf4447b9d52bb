"""What all results share: pages, pictures, folders, progress bars and worker processes."""
