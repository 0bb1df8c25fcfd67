"""What keeps the project in order: the system's libraries, pictures, and the pages that are written from the code."""
